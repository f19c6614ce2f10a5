// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planning/windowed_pid.h"

namespace cdiff::planning {
namespace {

// 2 e + 3 mean of the last three + 5 change, zeros before the first.
TEST(WindowedPid, AddsErrorMeanOfTheWindowAndChange) {
  WindowedPid pid({2.0, 3.0, 5.0}, 3);
  EXPECT_NEAR(pid.update(1.0), 2.0 + 3.0 * 1.0 / 3.0 + 5.0, 1e-12);
  EXPECT_NEAR(pid.update(2.0), 4.0 + 3.0 * 3.0 / 3.0 + 5.0, 1e-12);
  EXPECT_NEAR(pid.update(-1.0), -2.0 + 3.0 * 2.0 / 3.0 - 15.0, 1e-12);
  EXPECT_NEAR(pid.update(4.0), 8.0 + 3.0 * 5.0 / 3.0 + 25.0, 1e-12) << "the first is forgotten";
  EXPECT_NEAR(pid.update(0.0), 0.0 + 3.0 * 3.0 / 3.0 - 20.0, 1e-12);
  EXPECT_NEAR(pid.update(0.0), 0.0 + 3.0 * 4.0 / 3.0, 1e-12);
}

/// Outputs that are the errors themselves; at most three quarters of the throttle.
PlanPids plain() {
  PlanPidOptions options;
  options.turn = {1.0, 0.0, 0.0};
  options.speed = {1.0, 0.0, 0.0};
  options.max_throttle = 0.75;
  return PlanPids(options);
}

TEST(PlanPids, LimitSteeringToBothSides) {
  EXPECT_EQ(plain().track(5.0, 5.0, 0.4).steer, 0.4);
  EXPECT_EQ(plain().track(5.0, 5.0, -0.4).steer, -0.4);
  EXPECT_EQ(plain().track(5.0, 5.0, 1.5).steer, 1.0);
  EXPECT_EQ(plain().track(5.0, 5.0, -1.5).steer, -1.0);
}

TEST(PlanPids, LimitTheThrottle) {
  EXPECT_EQ(plain().track(5.0, 5.5, 0.0).throttle, 0.5);
  EXPECT_EQ(plain().track(5.0, 9.0, 0.0).throttle, 0.75);
  EXPECT_EQ(plain().track(5.25, 5.0, 0.0).throttle, 0.0) << "too fast, but by less than a tenth";
  EXPECT_EQ(plain().track(5.25, 5.0, 0.0).brake, 0.0);
}

// It brakes below 0.4 m/s, and above 1.1 times the desired speed.
TEST(PlanPids, BrakeAtTheirLimits) {
  EXPECT_FALSE(plain().brakes(0.0, 0.4));
  EXPECT_TRUE(plain().brakes(0.0, 0.39));
  EXPECT_FALSE(plain().brakes(1.1 * 5.0, 5.0));
  EXPECT_TRUE(plain().brakes(5.51, 5.0));
  const traffic::ControlAction action = plain().track(0.0, 0.39, 0.3);
  EXPECT_EQ(action.brake, 1.0);
  EXPECT_EQ(action.throttle, 0.0);
  EXPECT_EQ(action.steer, 0.3);
}

TEST(PlanPids, BearingsAreInRightAngles) {
  EXPECT_NEAR(turnErrorToward({2.0, 0.0}), 0.0, 1e-12);
  EXPECT_NEAR(turnErrorToward({0.0, 3.0}), 1.0, 1e-12);
  EXPECT_NEAR(turnErrorToward({1.0, -1.0}), -0.5, 1e-12);
}

}  // namespace
}  // namespace cdiff::planning
