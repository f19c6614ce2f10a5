// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/planning/planner.h"

namespace cdiff::planning {
namespace {

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
