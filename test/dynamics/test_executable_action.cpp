// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "dynamics/action_rollout.h"

namespace cdiff::dynamics {
namespace {

traffic::ControlAction executed(double throttle, double steer, double brake) {
  traffic::Rollout rollout = traffic::Rollout::Zero(1, traffic::kRolloutColumns);
  rollout.row(0).tail<traffic::kActionColumns>() << throttle, steer, brake;
  const traffic::ControlAction action = executableAction(rollout, 0);
  makeExecutable(rollout);
  EXPECT_EQ(rollout(0, traffic::kRolloutThrottle), action.throttle);
  EXPECT_EQ(rollout(0, traffic::kRolloutSteer), action.steer);
  EXPECT_EQ(rollout(0, traffic::kRolloutBrake), action.brake);
  return action;
}

TEST(ExecutableAction, OnePedalActs) {
  EXPECT_EQ(executed(0.6, 0.0, 0.4).brake, 0.0);
  EXPECT_EQ(executed(0.6, 0.0, 0.4).throttle, 0.6);
  EXPECT_EQ(executed(0.3, 0.0, 0.4).brake, 0.4);
  EXPECT_EQ(executed(0.3, 0.0, 0.4).throttle, 0.0);
  EXPECT_EQ(executed(0.02, 0.0, 0.04).brake, 0.0);  // noise around none
  EXPECT_EQ(executed(0.02, 0.0, 0.04).throttle, 0.02);
}

TEST(ExecutableAction, IsInRange) {
  EXPECT_EQ(executed(1.3, 0.0, 0.0).throttle, 1.0);
  EXPECT_EQ(executed(-0.2, 0.0, 1.4).brake, 1.0);
  EXPECT_EQ(executed(0.0, 1.7, 0.0).steer, 1.0);
  EXPECT_EQ(executed(0.0, -1.7, 0.0).steer, -1.0);
}

}  // namespace
}  // namespace cdiff::dynamics
