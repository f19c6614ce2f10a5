// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The scene of tests of planners with a network: a straight road with an ego at the origin and a
/// CBV 30 m and another 60 m ahead, each with an image of its own; the model is random.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "planners/course.h"
#include "planners/diffusion/diffusion_options.h"
#include "planners/diffusion/diffusion_planner.h"
#include "support/front_views.h"
#include "support/random_model.h"
#include "support/temporary_folder.h"

namespace cdiff::planners::testing {

inline traffic::CameraImage stripedImage(int shade) {
  traffic::CameraImage image;
  image.width = 160;
  image.height = 96;
  for (int i = 0; i < 160 * 96 * 3; ++i)
    image.rgb.push_back(static_cast<std::uint8_t>(shade + i % 97));
  return image;
}

/// Fixture; the model is written once for all its tests.
class ModelCourse : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    cdiff::testing::writeRandomModel(folder_->path());
  }
  static void TearDownTestSuite() { folder_.reset(); }

  ModelCourse() {
    for (int i = 0; i < 3; ++i) {
      traffic::Vehicle vehicle =
          vehicleAt(i == 0 ? "ego" : "cbv" + std::to_string(30 * i), 30.0 * i, 0.0, 0.0, 5.0);
      vehicle.role = i == 0 ? traffic::VehicleRole::kEgo : traffic::VehicleRole::kCbv;
      vehicle.cbv_slot = i - 1;
      snapshot_.vehicles.push_back(vehicle);
    }
    images_ = {stripedImage(0), stripedImage(40)};
  }

  /// Both CBVs, in slot order.
  std::vector<planning::PlanningTask> tasks() {
    return {{0, &snapshot_.vehicles[1], &route_, 8.0, test::frontViews(&images_[0])},
            {1, &snapshot_.vehicles[2], &route_, 8.0, test::frontViews(&images_[1])}};
  }
  /// Of the random model.
  static DiffusionOptions optionsOf(const std::string& mode = "real_time",
                                    const std::string& branch = "learned") {
    DiffusionOptions options;
    options.model = folder_->path().string();
    options.sampler.mode = mode;
    options.state_branch = branch;
    return options;
  }
  std::unique_ptr<DiffusionPlanner> makeDiffusion(const DiffusionOptions& options) const {
    return std::make_unique<DiffusionPlanner>(options, guidance_, dynamics::BicycleModelOptions{},
                                              context_);
  }
  void goTo(std::uint64_t tick) {
    snapshot_.tick = tick;
    for (traffic::CameraImage& image : images_) image.tick = tick;
  }

  inline static std::unique_ptr<test::TemporaryFolder> folder_;
  map::RoadNetwork network_ = makeNetwork({{"road", straight(-50.0, 0.0, 250.0, 0.0)}});
  map::DrivableArea area_{network_};
  map::Route route_ = routeAlong(network_, {"road"});
  planning::PlanningContext context_{network_, area_};
  guidance::GuidanceOptions guidance_ = guidance::loadProfile("naturalistic");
  traffic::TrafficSnapshot snapshot_;
  std::vector<traffic::CameraImage> images_;
};

}  // namespace cdiff::planners::testing
