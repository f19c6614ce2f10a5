// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/planning/planner.h"

namespace cdiff::planning {
namespace {

rendering::CameraRig rigOf(const std::vector<std::string>& names) {
  rendering::CameraRig rig;
  for (const std::string& name : names) {
    rig.cameras.emplace_back();
    rig.cameras.back().name = name;
  }
  return rig;
}

// Images come in the rig's order.
TEST(CameraViews, FindsTheImageOfACamera) {
  const rendering::CameraRig rig = rigOf({"front", "left", "rear"});
  const traffic::CameraImage front, left, rear;
  CameraViews views{&rig, {&front, &left, &rear}};
  EXPECT_EQ(views.find("front"), &front);
  EXPECT_EQ(views.find("left"), &left);
  EXPECT_EQ(views.find("rear"), &rear);
  EXPECT_EQ(views.find("right"), nullptr);
  EXPECT_EQ(views.missing(), "");
}

TEST(CameraViews, NamesTheFirstCameraWithoutAnImage) {
  const rendering::CameraRig rig = rigOf({"front", "left", "rear"});
  const traffic::CameraImage image;
  EXPECT_EQ((CameraViews{&rig, {&image, nullptr, nullptr}}.missing()), "left");
  EXPECT_EQ((CameraViews{&rig, {&image, &image}}.missing()), "rear") << "one too few";
  EXPECT_EQ((CameraViews{&rig, {}}.missing()), "front");
  EXPECT_EQ((CameraViews{nullptr, {&image}}.missing()), "");
  EXPECT_EQ((CameraViews{nullptr, {&image}}.find("front")), nullptr);
}

TEST(FailSafeAction, IsFullBrakingWithTheReason) {
  traffic::Vehicle vehicle;
  vehicle.id = "bg_3";
  PlanningTask task;
  task.slot = 2;
  task.vehicle = &vehicle;
  const PlannedAction action = failSafeAction(task, "it has no route");
  EXPECT_EQ(action.slot, 2);
  EXPECT_EQ(action.vehicle_id, "bg_3");
  EXPECT_EQ(action.action, traffic::ControlAction::failSafe());
  EXPECT_EQ(action.fault, "vehicle 'bg_3': it has no route; full braking instead");
  EXPECT_EQ(failSafeAction(task, "").fault, "");
}

}  // namespace
}  // namespace cdiff::planning
