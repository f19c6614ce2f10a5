// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"

namespace cdiff::dynamics {
namespace {

traffic::VehicleState moving(double speed) {
  traffic::VehicleState state;
  state.speed = speed;
  return state;
}

/// Mean acceleration over one tick of 0.05 s.
double acceleration(double speed_kmh, const traffic::ControlAction& action) {
  const traffic::VehicleState state = moving(speed_kmh / 3.6);
  return (BicycleModel().step(state, action, 0.05).speed - state.speed) / 0.05;
}

TEST(BicycleModel, FullThrottleAcceleratesAsTheFitSays) {
  // At rest the polynomial is -0.380192912 + 1.74950069 = 1.369307778 km/h per tick = 7.6073 m/s^2.
  EXPECT_NEAR(acceleration(0.0, {1.0, 0.0, 0.0}), 1.369307778 / 3.6 / 0.05, 1e-9);
  EXPECT_NEAR(acceleration(20.0, {1.0, 0.0, 0.0}), 6.0, 0.06);
  EXPECT_NEAR(acceleration(40.0, {1.0, 0.0, 0.0}), 4.7, 0.06);
  EXPECT_NEAR(acceleration(60.0, {1.0, 0.0, 0.0}), 3.6, 0.06);
}

TEST(BicycleModel, HalfThrottleAcceleratesAsTheFitSays) {
  // At rest: -0.380192912 x 0.5 + 1.74950069 x 0.25 = 0.2472787165 km/h per tick = 1.3738 m/s^2.
  EXPECT_NEAR(acceleration(0.0, {0.5, 0.0, 0.0}), 0.2472787165 / 3.6 / 0.05, 1e-9);
  EXPECT_NEAR(acceleration(50.0, {0.5, 0.0, 0.0}), 0.2, 0.05);
}

TEST(BicycleModel, LittleThrottleKeepsTheSpeed) {
  EXPECT_EQ(BicycleModel().step(moving(8.0), {0.29, 0.0, 0.0}, 0.5).speed, 8.0);
  EXPECT_EQ(BicycleModel().step(moving(0.0), {0.29, 0.0, 0.0}, 0.5).speed, 0.0);
  EXPECT_GT(BicycleModel().step(moving(0.0), {0.3, 0.0, 0.0}, 0.05).speed, 0.0);
}

TEST(BicycleModel, BrakingIsCapped) {
  // The fit gives -16.6 m/s^2 at 20 km/h and -31 m/s^2 at 140 km/h; the cap is 8.
  EXPECT_NEAR(acceleration(20.0, {0.0, 0.0, 1.0}), -8.0, 1e-9);
  EXPECT_NEAR(acceleration(140.0, {0.0, 0.0, 1.0}), -8.0, 1e-9);
}

TEST(BicycleModel, BrakingBelowTheCapFollowsTheFit) {
  // 40 km/h: the polynomial gives 38.7549 km/h after a tick, that is -6.9174 m/s^2 (computed with
  // exact decimals).
  EXPECT_NEAR(acceleration(40.0, {0.0, 0.0, 1.0}), -6.917404804799984, 1e-9);
  // 1 km/h: 0.0093171137 + 0.0820967431 - 0.0028383243 + ... = 0.0886255 km/h.
  EXPECT_NEAR(BicycleModel().step(moving(1.0 / 3.6), {0.0, 0.0, 1.0}, 0.05).speed * 3.6,
              0.08862570335945101, 1e-12);
}

TEST(BicycleModel, PartialBrakeScalesTheDeceleration) {
  EXPECT_NEAR(acceleration(20.0, {0.0, 0.0, 0.25}), -2.0, 1e-9);
  // Both pedals: 0.5 x 7.6073 + 0.5 x 0 at rest; 0.5 x 6.0493 - 0.5 x 8 at 20 km/h.
  EXPECT_NEAR(acceleration(20.0, {1.0, 0.0, 0.5}), 0.5 * 6.049338739999991 - 4.0, 1e-9);
}

TEST(BicycleModel, StopsAndNeverReverses) {
  traffic::VehicleState state = moving(8.0);
  const BicycleModel model;
  for (int i = 0; i < 60; ++i) {
    const traffic::VehicleState next = model.step(state, {0.0, 0.0, 1.0}, 0.05);
    ASSERT_GE(next.speed, 0.0);
    ASSERT_GE(next.position.x(), state.position.x());
    state = next;
  }
  EXPECT_EQ(state.speed, 0.0);
  // At least v^2 / (2 x 8) = 4 m, plus half a tick of 8 m/s for Euler, plus a softer end below 2
  // km/h.
  EXPECT_GT(state.position.x(), 4.0);
  EXPECT_LT(state.position.x(), 4.8);
}

TEST(BicycleModel, NeverExceedsTheMaximumSpeed) {
  EXPECT_EQ(BicycleModel().step(moving(39.9), {1.0, 0.0, 0.0}, 2.0).speed, 40.0);
}

TEST(BicycleModel, DrivesStraightWithoutSteer) {
  traffic::VehicleState state = moving(10.0);
  state.heading = 0.5 * core::kPi;
  state.elevation = 3.0;
  const traffic::VehicleState next = BicycleModel().step(state, {0.0, 0.0, 0.0}, 1.0);
  EXPECT_NEAR(next.position.x(), 0.0, 1e-12);
  EXPECT_NEAR(next.position.y(), 10.0, 1e-12);
  EXPECT_EQ(next.heading, 0.5 * core::kPi);
  EXPECT_EQ(next.elevation, 3.0);
}

/// Radius of the circle through three positions half a second apart.
double turningRadius(double steer) {
  const BicycleModel model;
  const traffic::VehicleState a = moving(4.0);
  const traffic::VehicleState b = model.step(a, {0.0, steer, 0.0}, 0.5);
  const traffic::VehicleState c = model.step(b, {0.0, steer, 0.0}, 0.5);
  const Eigen::Vector2d ab = b.position - a.position;
  const Eigen::Vector2d ac = c.position - a.position;
  const double area = 0.5 * std::abs(geometry::cross(ab, ac));
  return ab.norm() * ac.norm() * (c.position - b.position).norm() / (4.0 * area);
}

TEST(BicycleModel, CircleRadiusFollowsFromTheSteer) {
  // radius = l_r / sin(slip) = l_r / sin(atan(l_r / (l_f + l_r) tan(0.36848336 steer))); the points
  // of the Euler steps lie on a circle of radius r' with v dt = 2 r' sin(v dt / (2 r)), which at 4
  // m/s differs from r by less than 0.01 %.
  for (const double steer : {0.1, 0.3, 1.0}) {
    const double slip = std::atan(1.4178275 / 1.327058485 * std::tan(0.36848336 * steer));
    EXPECT_NEAR(turningRadius(steer), 1.4178275 / std::sin(slip),
                2e-4 * 1.4178275 / std::sin(slip));
  }
}

TEST(BicycleModel, PositiveSteerTurnsLeftAndMirrorsExactly) {
  const traffic::VehicleState left = BicycleModel().step(moving(6.0), {0.6, 0.4, 0.0}, 1.0);
  const traffic::VehicleState right = BicycleModel().step(moving(6.0), {0.6, -0.4, 0.0}, 1.0);
  EXPECT_GT(left.position.y(), 0.0);
  EXPECT_GT(left.heading, 0.0);
  EXPECT_EQ(left.position.x(), right.position.x());
  EXPECT_EQ(left.position.y(), -right.position.y());
  EXPECT_EQ(left.heading, -right.heading);
  EXPECT_EQ(left.speed, right.speed);
}

TEST(BicycleModel, LongStepEqualsShortSteps) {
  const BicycleModel model;
  const traffic::ControlAction action{0.7, 0.2, 0.0};
  traffic::VehicleState state = moving(5.0);
  for (int i = 0; i < 6; ++i) state = model.step(state, action, 0.05);
  const traffic::VehicleState whole = model.step(moving(5.0), action, 0.3);
  EXPECT_EQ(state.position, whole.position);
  EXPECT_EQ(state.heading, whole.heading);
  EXPECT_EQ(state.speed, whole.speed);
}

TEST(BicycleModel, RefusesInvalidActionsAndDurations) {
  const BicycleModel model;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(model.step(moving(5.0), {1.1, 0.0, 0.0}, 0.05), std::invalid_argument);
  EXPECT_THROW(model.step(moving(5.0), {0.0, nan, 0.0}, 0.05), std::invalid_argument);
  EXPECT_THROW(model.step(moving(5.0), {0.0, 0.0, -0.1}, 0.05), std::invalid_argument);
  EXPECT_THROW(model.step(moving(5.0), {}, 0.07), std::invalid_argument);
  EXPECT_THROW(model.step(moving(5.0), {}, -0.05), std::invalid_argument);
  EXPECT_NO_THROW(model.step(moving(5.0), {}, 0.1 + 0.2));
}

TEST(BicycleModelOptions, RefusesAWheelbaseThatIsNotPositive) {
  BicycleModelOptions options;
  options.front_length = -options.rear_length;
  EXPECT_THROW(BicycleModel{options}, core::InputError);
}

}  // namespace
}  // namespace cdiff::dynamics
