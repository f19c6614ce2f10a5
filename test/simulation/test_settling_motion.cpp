// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// How a vehicle of 4 m that is given back to SUMO comes to where SUMO has it; steps of 0.05 s.
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "simulation/driven_fleet.h"

namespace cdiff::simulation {
namespace {

constexpr double kStep = 0.05;
constexpr double kLength = 4.0;

traffic::VehicleState at(double x, double y, double heading, double speed) {
  traffic::VehicleState state;
  state.position = {x, y};
  state.heading = heading;
  state.speed = speed;
  return state;
}

/// Heading two steps after a release `offset` to the left of the lane and `turned` against it, at
/// 1 m/s: reach 3 m, 0.05 m driven.
double headingAfterTwo(double offset, double turned) {
  const Eigen::Vector2d front(10.0 + 2.0 + kStep * std::cos(turned), offset);
  const Eigen::Vector2d behind =
      2.0 * geometry::direction(turned) + kStep * geometry::direction(turned);
  SettlingMotion motion(at(front.x() - behind.x(), front.y() - behind.y(), turned, 1.0), kLength);
  motion.advance(at(10.0, 0.0, 0.0, 1.0), kStep);
  return motion.advance(at(10.05, 0.0, 0.0, 1.0), kStep).heading;
}

// The first step is straight on. In the second, reach = 0.8 s x 8 m/s = 6.4 m and 0.4 m are driven:
// curvature -1 / 6.4^2 = -0.02441406, heading -0.009765625, offset 1 - 0.4 sin 0.009765625
// = 0.99609381; along 0.3 (1 - 0.4 / 6.4) = 0.28125. Center: front (12.78125, 0.99609381) minus 2 m
// along the heading.
TEST(SettlingMotion, GoesStraightOnAndThenTurnsToItsLane) {
  for (const double east : {0.0, 0.5 * core::kPi}) {
    const auto turned = [&](traffic::VehicleState state) {
      state.position = geometry::Pose2d{{0.0, 0.0}, east}.toMap(state.position);
      state.heading += east;
      return state;
    };
    SettlingMotion motion(turned(at(10.0, 1.0, 0.0, 8.0)), kLength);
    EXPECT_FALSE(motion.settled());
    const traffic::VehicleState first = motion.advance(turned(at(10.1, 0.0, 0.0, 8.0)), kStep);
    EXPECT_LT((first.position - turned(at(10.4, 1.0, 0.0, 8.0)).position).norm(), 1e-9);
    EXPECT_NEAR(first.heading, east, 1e-12);
    const traffic::VehicleState second = motion.advance(turned(at(10.5, 0.0, 0.0, 8.0)), kStep);
    EXPECT_NEAR(second.heading, east - 0.009765625, 1e-9);
    const Eigen::Vector2d place = turned(at(10.78134537, 1.01562475, 0.0, 8.0)).position;
    EXPECT_LT((second.position - place).norm(), 1e-7);
    EXPECT_FALSE(motion.settled());
  }
}

// Curvature -offset / 9 - 2 turned / 3, at most 0.2 per meter either way.
TEST(SettlingMotion, TurnsAsSharplyAsAVehicleMay) {
  EXPECT_NEAR(headingAfterTwo(0.9, 0.0), -0.05 * 0.1, 1e-9);
  EXPECT_NEAR(headingAfterTwo(-0.9, 0.0), 0.05 * 0.1, 1e-9);
  EXPECT_NEAR(headingAfterTwo(3.0, 0.0), -0.05 * 0.2, 1e-9);
  EXPECT_NEAR(headingAfterTwo(-3.0, 0.0), 0.05 * 0.2, 1e-9);
  EXPECT_NEAR(headingAfterTwo(0.0, 0.15), 0.15 - 0.05 * 0.1, 1e-9);
}

// 8 m in a step are more than the reach of 6.4 m: no difference along the lane is left.
TEST(SettlingMotion, DoesNotOvershootAlongTheLane) {
  SettlingMotion motion(at(0.0, 0.0, 0.0, 8.0), kLength);
  motion.advance(at(7.0, 0.0, 0.0, 8.0), 1.0);
  EXPECT_NEAR(motion.advance(at(15.0, 0.0, 0.0, 8.0), 1.0).position.x(), 15.0, 1e-9);
}

// 1 cm and 0.005 rad; at rest nothing moves before the first step. A heading error about the front
// leaves the front where it is.
TEST(SettlingMotion, IsSettledWithinACentimeterAndFiveMilliradians) {
  const auto settled = [](double x, double y, double heading) {
    const Eigen::Vector2d center =
        Eigen::Vector2d(12.0 + x, y) - 2.0 * geometry::direction(heading);
    SettlingMotion motion(at(center.x(), center.y(), heading, 0.0), kLength);
    motion.advance(at(10.0, 0.0, 0.0, 0.0), kStep);
    return motion.settled();
  };
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(settled(0.0095 * sign, 0.0095 * sign, 0.0048 * sign));
    EXPECT_FALSE(settled(0.0105 * sign, 0.0, 0.0));
    EXPECT_FALSE(settled(0.0, 0.0105 * sign, 0.0));
    EXPECT_FALSE(settled(0.0, 0.0, 0.0052 * sign));
  }
}

}  // namespace
}  // namespace cdiff::simulation
