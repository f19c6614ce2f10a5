// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// An ego on a straight road with the images of three cameras, and what the registry says to its
/// planner's options, weights and rig.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"
#include "inference/safetensors.h"
#include "planners/camera_ego/camera_ego_sizes.h"
#include "planners/course.h"
#include "planners/registry.h"
#include "planners/weight_files.h"
#include "support/temporary_folder.h"

namespace cdiff::planners::testing {

class CameraCourse : public ::testing::Test {
 protected:
  CameraCourse() {
    snapshot_.vehicles.push_back(vehicleAt("ego", 5.0, 0.0, 0.0, 6.0));
    for (std::size_t i = 0; i < 3; ++i) images_.push_back(image(i));
    goTo(0);
  }
  static traffic::CameraImage image(std::size_t number) {
    traffic::CameraImage image{160, 96, 0, {}};
    for (std::size_t i = 0; i < 160 * 96 * 3; ++i)
      image.rgb.push_back(static_cast<std::uint8_t>(i * (number + 3) % 251));
    return image;
  }
  void goTo(std::uint64_t tick) {
    snapshot_.tick = tick;
    snapshot_.vehicles[0].state.position.x() = 5.0 + 0.3 * static_cast<double>(tick);
    for (std::size_t i = 0; i < images_.size(); ++i) {
      images_[i].tick = tick;
      images_[i].rgb[i] = static_cast<std::uint8_t>(tick);
    }
  }
  planning::PlanningTask task() {
    planning::PlanningTask task;
    task.vehicle = &snapshot_.vehicles.front();
    task.route = &route_;
    task.views.rig = &rig_;
    for (const traffic::CameraImage& image : images_) task.views.images.push_back(&image);
    return task;
  }
  planning::PlannedAction planOf(planning::Planner& planner, const planning::PlanningTask& task) {
    return planner.plan(snapshot_, {task}).at(0);
  }
  planning::PlannerParts parts() const {
    planning::PlannerParts parts{{network_, area_}, options_, dynamics_, camera_, guidance_};
    parts.rig = rig_;
    return parts;
  }
  /// What the registry says to `assignment` of an option and a rig.
  std::string refusalOf(const std::string& planner, const std::string& assignment,
                        const rendering::RigOptions& rig) const {
    planning::PlannerOptionsTable options = defaultOptions();
    core::overrideOption(assignment, "test", options);
    planning::PlannerParts parts{{network_, area_}, options, dynamics_, camera_, guidance_};
    parts.rig_options = rig;
    try {
      makePlanner(planner, parts);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "made";
  }
  /// Weights in a folder of their own, of a format; the assignment that chooses them.
  std::string weightsOf(const WeightKind& kind, WeightMetadata metadata,
                        const WeightTensors& tensors, const char* format) const {
    metadata["format"] = format;
    inference::writeSafetensors(folder_.path() / kind.file, {metadata, tensors},
                                inference::TensorType::kF16);
    return std::string(kind.planner) + ".weights=" + folder_.path().string();
  }

  test::TemporaryFolder folder_;
  map::RoadNetwork network_ = makeNetwork({{"road", straight(0.0, 0.0, 300.0, 0.0)}});
  map::DrivableArea area_{network_};
  map::Route route_ = routeAlong(network_, {"road"});
  planning::PlannerOptionsTable options_ = defaultOptions();
  dynamics::BicycleModelOptions dynamics_;
  rendering::CameraOptions camera_;
  guidance::GuidanceOptions guidance_;
  rendering::CameraRig rig_ = CameraEgoSizes{}.cameras();
  traffic::TrafficSnapshot snapshot_;
  std::vector<traffic::CameraImage> images_;
};

}  // namespace cdiff::planners::testing
