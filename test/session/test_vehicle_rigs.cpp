// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"
#include "session/vehicle_rigs.h"

namespace cdiff::session {
namespace {

/// A planner whose rig is Bench2Drive's six, of which it needs all; known once.
const std::string& surroundPlanner() {
  static const std::string name = [] {
    planning::PlannerDescriptor descriptor = *planners::findPlanner(planners::kDefaultEgoPlanner);
    descriptor.name = "surround_test";
    descriptor.cameras = {"front", "front_left", "front_right", "back", "back_left", "back_right"};
    descriptor.rig = rendering::kBench2driveRig;
    descriptor.network = nullptr;
    descriptor.weights_sha256 = nullptr;
    planners::registerPlanner(descriptor, "this test");
    return descriptor.name;
  }();
  return name;
}

ScenarioOptions scenario(const std::string& ego_planner) {
  ScenarioOptions options;
  options.network = "crossing";
  options.ego_planner = ego_planner;
  return options;
}

std::string errorOf(const ScenarioOptions& options) {
  try {
    options.validate();
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(VehicleRigs, AreThoseThatThePlannersName) {
  ScenarioOptions options = scenario(surroundPlanner());
  EXPECT_EQ(VehicleRigs(options).of(traffic::kEgoSlot).cameras.size(), 6u);
  EXPECT_EQ(VehicleRigs(options).of(0).names(), std::vector<std::string>{"front"});
  EXPECT_EQ(VehicleRigs(scenario("external")).of(traffic::kEgoSlot).names(),
            std::vector<std::string>{"front"});
  options.camera.width = 200;
  EXPECT_EQ(VehicleRigs(options).of(traffic::kEgoSlot).cameras[5].width, 200);
}

TEST(VehicleRigs, SlotsHaveThoseOfTheirPlanners) {
  ScenarioOptions options = scenario(planners::kDefaultEgoPlanner);
  options.cbv_planner = "diffusion+" + surroundPlanner();
  const VehicleRigs rigs(options);
  EXPECT_EQ(errorOf(options), "no error");
  for (int slot = 0; slot < 4; ++slot)
    EXPECT_EQ(rigs.of(slot).cameras.size(), slot % 2 == 0 ? 1u : 6u) << slot;
}

TEST(VehicleRigs, ARigWithoutACameraThatThePlannerNeedsIsRefused) {
  ScenarioOptions options = scenario(surroundPlanner());
  EXPECT_EQ(errorOf(options), "no error");
  options.ego_rig.preset = rendering::kFrontThreeRig;
  EXPECT_EQ(errorOf(options),
            "ego_planner 'surround_test' needs the camera 'back'; the rig of key 'ego_rig' has "
            "front, front_left, front_right; expected a preset or own cameras that hold it");
  options = scenario("diffusion");
  options.ego_rig.preset = rendering::kOwnRig;
  options.ego_rig.cameras.resize(1);
  options.ego_rig.cameras[0].name = "rear";
  EXPECT_EQ(errorOf(options),
            "ego_planner 'diffusion' needs the camera 'front'; the rig of key 'ego_rig' has rear; "
            "expected a preset or own cameras that hold it");
}

TEST(VehicleRigs, AScenarioNamesCameraAndKeyOfABadRig) {
  ScenarioOptions options = scenario(planners::kDefaultEgoPlanner);
  try {
    core::loadOptions({"my.yaml",
                       "ego_rig:\n  preset: own\n  cameras:\n  - {name: left, yaw: 90}\n"
                       "  - {name: rear, z: -1}\n"},
                      options);
    FAIL() << "accepted";
  } catch (const core::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "my.yaml:5: key 'ego_rig.cameras[rear].z' is '-1'; expected a number in [0.2, 10] "
                 "m");
  }
}

}  // namespace
}  // namespace cdiff::session
