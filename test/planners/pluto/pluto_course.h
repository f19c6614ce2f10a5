// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A straight road with an ego and two CBVs behind each other, and Pluto with random weights.
#pragma once

#include <gtest/gtest.h>

#include "inference/safetensors.h"
#include "planners/course.h"
#include "planners/pluto/pluto.h"
#include "support/random_model.h"
#include "support/temporary_folder.h"

namespace cdiff::planners::testing {

/// A network that is trained in no time.
inline PlutoArchitecture smallPluto() {
  PlutoArchitecture architecture;
  architecture.width = 16;
  architecture.heads = 1;
  architecture.hidden = 32;
  architecture.encoder_layers = 1;
  architecture.decoder_layers = 1;
  architecture.polygons = 8;
  return architecture;
}

inline PlutoModel randomPluto(const PlutoArchitecture& architecture = {}) {
  return {architecture, cdiff::testing::randomTensors(plutoTensors(architecture))};
}

/// Into the file of `kind` in `folder`, which says that it is of `format`.
inline void writePluto(const std::filesystem::path& folder, const WeightKind& kind,
                       const char* format, const PlutoArchitecture& architecture = {}) {
  const PlutoModel model = randomPluto(architecture);
  auto metadata = networkMetadata(kind, model.architecture);
  metadata["format"] = format;
  std::filesystem::create_directories(folder);
  inference::writeSafetensors(folder / kind.file, {metadata, model.weights},
                              inference::TensorType::kF16);
}

/// Fixture.
class PlutoCourse : public ::testing::Test {
 protected:
  PlutoCourse() {
    for (int i = 0; i < 3; ++i) {
      traffic::Vehicle vehicle =
          vehicleAt(i == 0 ? "ego" : "cbv" + std::to_string(i), 20.0 * i, 0.0, 0.0, 5.0);
      vehicle.role = i == 0 ? traffic::VehicleRole::kEgo : traffic::VehicleRole::kCbv;
      vehicle.cbv_slot = i - 1;
      snapshot_.vehicles.push_back(vehicle);
    }
  }
  /// Both CBVs, in slot order.
  std::vector<planning::PlanningTask> tasks() {
    return {{0, &snapshot_.vehicles[1], &route_, 8.0}, {1, &snapshot_.vehicles[2], &route_, 8.0}};
  }
  PlutoPlanner makePlanner() const { return {PlutoOptions{}, randomPluto(), network_, 0.1}; }
  void advance() {
    snapshot_.tick += 2;
    snapshot_.time += 0.1;
    for (traffic::Vehicle& vehicle : snapshot_.vehicles) vehicle.state.position.x() += 0.5;
  }

  map::RoadNetwork network_ = makeNetwork({{"road", straight(-50.0, 0.0, 250.0, 0.0)}});
  map::Route route_ = routeAlong(network_, {"road"});
  traffic::TrafficSnapshot snapshot_;
};

}  // namespace cdiff::planners::testing
