// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "dynamics/action_rollout.h"
#include "e2e_cdiff/core/angle.h"

namespace cdiff::dynamics {
namespace {

ObservedMotion motionOf(const BicycleModel& model, double speed,
                        const traffic::ControlAction& action) {
  traffic::VehicleState state;
  state.speed = speed;
  const traffic::VehicleState next = model.step(state, action, 0.1);
  return {speed, next.speed, core::angleDifference(next.heading, state.heading)};
}

TEST(ActionInference, ReproducesTheMotionThatAnActionMade) {
  const BicycleModel model;
  for (const double speed : {1.0, 4.0, 8.0, 13.0}) {
    for (const traffic::ControlAction& action :
         {traffic::ControlAction{0.6, 0.2, 0.0}, traffic::ControlAction{0.9, -0.4, 0.0},
          traffic::ControlAction{0.0, 0.1, 0.4}, traffic::ControlAction{0.0, -0.05, 1.0}}) {
      const ObservedMotion motion = motionOf(model, speed, action);
      const ObservedMotion again = motionOf(model, speed, inferAction(model, motion));
      EXPECT_NEAR(again.next_speed, motion.next_speed, 0.02) << speed;
      EXPECT_NEAR(again.turn, motion.turn, 0.02 * std::abs(motion.turn) + 1e-6) << speed;
    }
  }
}

TEST(ActionInference, KeepsToTheGentlestAndWithinTheRange) {
  const BicycleModel model;
  const traffic::ControlAction still = inferAction(model, {0.0, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(still.throttle, 0.0);
  EXPECT_DOUBLE_EQ(still.steer, 0.0);
  EXPECT_DOUBLE_EQ(still.brake, 0.0);
  const traffic::ControlAction impossible = inferAction(model, {5.0, 0.0, 1.0});
  EXPECT_TRUE(impossible.valid());
  EXPECT_DOUBLE_EQ(impossible.steer, 1.0);
  EXPECT_GT(impossible.brake, 0.9);
}

TEST(ActionInference, NeverHoldsBothPedals) {
  const BicycleModel model;
  for (double next = 0.0; next < 12.0; next += 0.1) {
    const traffic::ControlAction action = inferAction(model, {6.0, next, 0.0});
    EXPECT_DOUBLE_EQ(action.throttle * action.brake, 0.0);
  }
}

}  // namespace
}  // namespace cdiff::dynamics
