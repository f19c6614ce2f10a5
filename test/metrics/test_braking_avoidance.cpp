// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "metrics/formulas/braking_avoidance.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::ego;

constexpr double kStep = 0.05;  // [s]

/// Vehicles of 4.8 m x 1.8 m; ticks 0.05 s apart. The route lies on y = 0 from x = 0 to 100 m.
class BrakingAvoidanceTest : public ::testing::Test {
 protected:
  static void observe(BrakingAvoidance& avoidance, std::uint64_t tick, const traffic::Vehicle& own,
                      const traffic::Vehicle& other) {
    avoidance.observe(test::snapshot(tick, {own, other}), own.state.position.x());
  }
  /// The ego drives along the road from (0, y) at its speed, the other from its place at its
  /// velocity, until their boxes overlap.
  bool brakingAvoids(double speed, traffic::Vehicle other, double y = 0.0) {
    BrakingAvoidance avoidance(road_.route);
    for (std::uint64_t tick = 0; tick < 400; ++tick) {
      const traffic::Vehicle own = ego(speed * kStep * static_cast<double>(tick), y, speed);
      observe(avoidance, tick, own, other);
      if (overlap(own.box(), other.box())) return avoidance.avoids("v");
      other.state.position += kStep * other.state.velocity();
    }
    ADD_FAILURE() << "they never met";
    return false;
  }
  static traffic::Vehicle heading(traffic::Vehicle vehicle, double degrees) {
    vehicle.state.heading = core::degreesToRadians(degrees);
    return vehicle;
  }

  test::StraightRoad road_;
};

TEST_F(BrakingAvoidanceTest, AStandingVehicleInPlainSightIsAvoided) {
  // 8 m/s reach 8 (0.5 + 8 / 6) = 14.67 m, of which reaction and braking take 4 + 64 / 12 = 9.33 m.
  EXPECT_TRUE(brakingAvoids(8.0, background("v", 60, 0, 0)));
}

// Beside its route the ego's path is the route's as long as it is not 2 m off: 0.9 m to each side,
// where the other, from 1 m to 2.8 m, is not. Farther off it is straight ahead.
TEST_F(BrakingAvoidanceTest, TwoMetersOffItsRouteItsPathIsStraightAhead) {
  EXPECT_FALSE(brakingAvoids(8.0, background("v", 60, 1.9, 0), 1.9));
  EXPECT_TRUE(brakingAvoids(8.0, background("v", 60, 2.1, 0), 2.1));
}

TEST_F(BrakingAvoidanceTest, WhatComesIntoThePathWithinTheReactionIsNot) {
  // At 10 m/s 0.5 s are 5 m. It is there with its rear 4.9 m before the ego's front: contact at
  // 0.5 s, where braking sets in. With 5.4 m the ego has 0.4 m to brake.
  EXPECT_FALSE(brakingAvoids(10.0, background("v", 9.7, 0, 0)));
  EXPECT_FALSE(brakingAvoids(10.0, background("v", 10.2, 0, 0)));
}

TEST_F(BrakingAvoidanceTest, BrakingMustBeEnoughForAStandingVehicle) {
  // At 6 m/s the ego needs 3 + 36 / 12 = 6 m. A vehicle that is there from the first tick on, 6.05
  // m ahead, is avoided; one 5.95 m ahead is not, though the driven ego touches it after 1 s, when
  // the braking one is only at 3 + 3 - 0.75 = 5.25 m.
  EXPECT_TRUE(brakingAvoids(6.0, background("v", 4.8 + 6.05, 0, 0)));
  EXPECT_FALSE(brakingAvoids(6.0, background("v", 4.8 + 5.95, 0, 0)));
}

TEST_F(BrakingAvoidanceTest, NeitherAnOncomingVehicleNorAStrikeFromBehindIsHelpedByBraking) {
  EXPECT_FALSE(brakingAvoids(8.0, heading(background("v", 90, 0, 8), 180.0)));
  EXPECT_FALSE(brakingAvoids(4.0, background("v", -20, 0, 12)));
}

TEST_F(BrakingAvoidanceTest, AStandingEgoCouldNotAvoidIt) {
  EXPECT_FALSE(brakingAvoids(0.0, heading(background("v", 30, 0, 5), 180.0)));
}

// It drives north at x = 30: its box, 1.8 m broad along the road, is at 29.1 to 30.9. Its front,
// y_0 + 2.4 + v t, enters the ego's swept path at y = -0.9; its rear leaves it at y = 0.9. The
// ego's front, 2.4 + 10 t, comes to 29.1 at 2.67 s, that is by the tick of 2.7 s.
TEST_F(BrakingAvoidanceTest, ACrossingVehicleIsHitWhereTheBrakingEgoComesTooSoon) {
  // In the path from 1.57 s (tick 1.6) to 2.89 s. The ego brakes from 2.1 s, its front at 23.4, and
  // is at 29.1 when 10 s - 3 s^2 = 5.7: s = 0.73, at 2.83 s.
  EXPECT_FALSE(brakingAvoids(10.0, heading(background("v", 30, -11.15, 5), 90.0)));
}

TEST_F(BrakingAvoidanceTest, ACrossingVehicleIsAvoidedWhereTheBrakingEgoComesAfterIt) {
  // In the path from 1.62 s (tick 1.65) to 2.72 s. The ego brakes from 2.15 s, its front at 23.9,
  // and is at 29.1 when 10 s - 3 s^2 = 5.2: s = 0.64, at 2.79 s.
  EXPECT_TRUE(brakingAvoids(10.0, heading(background("v", 30, -13.02, 6), 90.0)));
}

TEST_F(BrakingAvoidanceTest, LeavingThePathForgetsWhenItWasEntered) {
  // In the path for 2 s, then 5 m aside for a tick, then before the bumper.
  BrakingAvoidance avoidance(road_.route);
  for (std::uint64_t tick = 0; tick <= 40; ++tick) {
    const double x = 0.25 * static_cast<double>(tick);
    observe(avoidance, tick, ego(x, 0, 5), background("v", x + 7, 0, 5));
  }
  observe(avoidance, 41, ego(10.25, 0, 5), background("v", 17.25, 5, 5));
  observe(avoidance, 42, ego(10.5, 0, 5), background("v", 15.2, 0, 5));
  EXPECT_FALSE(avoidance.avoids("v"));
  // Before the bumper for 2 s more, it has been in the path for long enough.
  for (std::uint64_t tick = 43; tick <= 82; ++tick) {
    const double x = 0.25 * static_cast<double>(tick);
    observe(avoidance, tick, ego(x, 0, 5), background("v", x + 7, 0, 5));
  }
  observe(avoidance, 83, ego(20.75, 0, 5), background("v", 25.45, 0, 5));
  EXPECT_TRUE(avoidance.avoids("v"));
}

TEST_F(BrakingAvoidanceTest, AVehicleAboveThePathIsNotInIt) {
  BrakingAvoidance avoidance(road_.route);
  traffic::Vehicle above = background("v", 30, 0, 0);
  above.state.elevation = 6.0;
  for (std::uint64_t tick = 0; tick <= 20; ++tick)
    observe(avoidance, tick, ego(20 + 0.25 * static_cast<double>(tick), 0, 5), above);
  EXPECT_FALSE(avoidance.avoids("v"));
  EXPECT_FALSE(avoidance.avoids("nobody"));
}

}  // namespace
}  // namespace cdiff::metrics
