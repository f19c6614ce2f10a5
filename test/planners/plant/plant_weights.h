// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Weights of PlanT for tests: small sizes, drawn or constant.
#pragma once

#include <filesystem>
#include <string>

#include "planners/plant/plant_network.h"
#include "support/tensors.h"

namespace cdiff::planners::testing {

inline PlantArchitecture smallPlant() {
  PlantArchitecture architecture;
  architecture.layers = 2;
  architecture.width = 32;
  architecture.heads = 2;
  architecture.hidden = 48;
  architecture.vehicles = 4;
  return architecture;
}

/// Every value uniform in [-bound, bound].
inline PlantModel drawnPlant(double bound, const PlantArchitecture& architecture = smallPlant()) {
  return {architecture, test::uniformTensors(plantTensors(architecture), bound)};
}

/// All 0 but the bias of a step from waypoint to waypoint, (x, y) [m]: what it plans.
inline PlantModel constantPlant(double x, double y) {
  PlantModel model = drawnPlant(0.0);
  model.weights.at("step.bias").values = {static_cast<float>(x / kPlantStepScale),
                                          static_cast<float>(y / kPlantStepScale)};
  return model;
}

inline void writePlant(const std::filesystem::path& folder, const PlantModel& model) {
  inference::writeSafetensors(folder / kPlant.file,
                              {networkMetadata(kPlant, model.architecture), model.weights},
                              inference::TensorType::kF32);
}

}  // namespace cdiff::planners::testing
