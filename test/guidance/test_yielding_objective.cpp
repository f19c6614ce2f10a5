// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "guidance/guidance_world.h"
#include "guidance/yielding_objective.h"

namespace cdiff::guidance {
namespace {

using test::GuidanceWorld;
using test::standing;
using test::valueOf;

/// The planned vehicle 40 m along a straight road at 8 m/s, target speed 8 m/s; boxes of 4.5 m x
/// 1.8 m. Rows 0.1 s apart.
class Yielding : public ::testing::Test {
 protected:
  Yielding() {
    world_.scene().traffic.clear();
    world_.scene().other = nullptr;
  }

  /// A vehicle that comes from the right at right angles, its center `x` m along the road and
  /// `across` m from its middle now, with a constant speed.
  OtherMotion& addCrossing(double x, double across, double speed) {
    OtherMotion other;
    other.now = world_.placed(x, across, 0.5 * core::kPi, speed);
    for (std::size_t row = 1; row <= 32; ++row) {
      other.predicted.push_back(world_.placed(x, across + 0.1 * speed * static_cast<double>(row),
                                              0.5 * core::kPi, speed));
    }
    world_.scene().traffic.push_back(other);
    return world_.scene().traffic.back();
  }
  double valueAt(double ahead, Eigen::Index rows = 32) {
    return valueOf(objective_, world_.scene(), standing(ahead, 0.0, 0.0, 0.0, rows));
  }

  GuidanceWorld world_;
  YieldingObjective objective_;
};

// It stands across the road 20 m ahead (x = 60): its box begins at 59.1. The front of ours with the
// gap is 2.25 + 1 m ahead of the center, so it may come to 55.85; places are 0.5 m apart, so the
// first that meets is 56.0, 16 m ahead.
TEST_F(Yielding, CountsTheSquaresBeyondTheFirstPlaceThatMeets) {
  addCrossing(60.0, 0.0, 0.0);
  EXPECT_EQ(valueAt(15.9, 1), 0.0);
  EXPECT_NEAR(valueAt(17.5, 1), 1.5 * 1.5, 1e-9);
  const auto gradient =
      test::gradientOf(objective_, world_.scene(), standing(17.5, 0.0, 0.0, 0.0, 1));
  EXPECT_NEAR(gradient(0, traffic::kRolloutX), 2.0 * 1.5, 1e-9);
  EXPECT_NEAR(gradient(0, traffic::kRolloutY), 0.0, 1e-9);
}

TEST_F(Yielding, KeepsTheGaps) {
  addCrossing(60.0, 3.8, 0.0);  // its front, 2.25 m on, is 1.55 m left of the middle: beyond 1.2
  EXPECT_EQ(valueAt(20.0, 1), 0.0);
  objective_.lateral_gap = 0.7;  // 1.6 m
  EXPECT_GT(valueAt(20.0, 1), 0.0);
  world_.scene().traffic.clear();
  addCrossing(60.0, 0.0, 0.0);
  objective_.longitudinal_gap = 3.0;  // 54 is the first place: 14 m ahead
  EXPECT_NEAR(valueAt(15.0, 1), 1.0, 1e-9);
}

// Its front is 8 - 2.25 m from the middle at 5 m/s; the strip begins 1.2 m before: it is there
// after 0.91 s, at row 10, and away, 2.25 m behind its center, after 2.29 s, at row 22 the last
// time. With the margin of 0.5 s rows 5 to 27 have a limit.
TEST_F(Yielding, HoldsForTheTimeThatTheOtherTakesAndItsMargin) {
  addCrossing(60.0, -8.0, 5.0);
  for (const int row : {4, 5, 27, 28}) {
    traffic::Rollout rollout = standing(0.0, 0.0, 0.0, 0.0, 32);
    rollout(row - 1, traffic::kRolloutX) = 18.0;
    EXPECT_EQ(valueOf(objective_, world_.scene(), rollout) > 0.0, row == 5 || row == 27) << row;
  }
}

// From 40 to past a vehicle at 48 m, 4.15 m on, 12.15 m at 8 m/s: 1.5 s and the margin.
TEST_F(Yielding, GoesFirstWhereItHasClearedTheWayInTime) {
  addCrossing(48.0, -8.45 - 2.25 - 1.2, 4.0);  // in the strip after 2.11 s
  EXPECT_EQ(valueAt(20.0), 0.0);
  world_.scene().traffic.clear();
  addCrossing(48.0, -7.2 - 2.25 - 1.2, 4.0);  // after 1.8 s
  EXPECT_GT(valueAt(20.0), 0.0);
}

TEST_F(Yielding, OfTwoByTheSameRulesOneWaits) {
  OtherMotion& other = addCrossing(60.0, -13.0, 5.0);
  EXPECT_GT(valueAt(20.0), 0.0);  // one that does not know of us
  other.by_same_rules = true;
  EXPECT_EQ(valueAt(20.0), 0.0);
  other.goes_first = true;
  EXPECT_GT(valueAt(20.0), 0.0);
}

TEST_F(Yielding, DoesNotBrakeForWhoComesFromBehindButForWhoIsBesideAndAhead) {
  OtherMotion& behind = addCrossing(30.0, 0.0, 0.0);
  behind.now = world_.placed(34.0, 0.0, 0.0, 10.0);
  for (std::size_t row = 0; row < 32; ++row)
    behind.predicted[row] = world_.placed(35.0 + static_cast<double>(row), 0.0, 0.0, 10.0);
  EXPECT_EQ(valueAt(20.0), 0.0);
  behind.now = world_.placed(42.0, 2.0, -0.2, 8.0);
  for (std::size_t row = 0; row < 32; ++row)
    behind.predicted[row] = world_.placed(42.0 + 0.8 * static_cast<double>(row), 1.0, 0.0, 8.0);
  EXPECT_GT(valueAt(20.0), 0.0);
}

// It comes toward us at 150 degrees, 1 m past us with its center; a part of it is still ahead of
// our front bumper until it is 2.4 m long.
TEST_F(Yielding, WaitsUntilAllOfOneThatPassesIsBehindTheFront) {
  OtherMotion& passing = addCrossing(39.0, 1.5, 0.0);
  for (const double length : {9.0, 2.4}) {
    passing.dimensions.length = length;
    for (traffic::VehicleState* state : {&passing.now, &passing.predicted[0]})
      *state = world_.placed(39.0, 1.5, core::kPi * 150.0 / 180.0, 4.0);
    EXPECT_EQ(valueAt(20.0) > 0.0, length == 9.0) << length;
  }
  passing.dimensions.length = 9.0;
  passing.now.speed = 0.0;  // it will not go on
  EXPECT_EQ(valueAt(20.0), 0.0);
}

// 1 m left of the line that continues the route backward, 4 m before its start at x = 0; and 2 m
// before its end at x = 100, for one that crosses 10 m beyond.
TEST_F(Yielding, LooksBeyondBothEndsOfTheRoute) {
  GuidanceScene& scene = world_.scene();
  scene.state = world_.placed(-4.0, 1.0, 0.0, 8.0);
  scene.route_arc_length = -4.0;
  addCrossing(6.0, 4.4, 0.0);    // its front is 6.65 m to the left, its rear 2.15 m
  EXPECT_GT(valueAt(9.0), 0.0);  // our left side with the gap: 1 + 0.9 + 0.3 m
  scene.traffic.clear();
  scene.state = world_.placed(98.0, 0.0, 0.0, 8.0);
  scene.route_arc_length = 98.0;
  addCrossing(110.0, 0.0, 0.0);
  EXPECT_GT(valueAt(12.0), 0.0);
}

TEST_F(Yielding, GivesWayToTheOtherVehicleUnlessItIsOnABridge) {
  OtherMotion ego = addCrossing(60.0, 0.0, 0.0);
  world_.scene().traffic.clear();
  world_.scene().other = &ego;
  EXPECT_GT(valueAt(20.0), 0.0);
  ego.now.elevation = 6.0;
  EXPECT_EQ(valueAt(20.0), 0.0);
}

TEST_F(Yielding, IsNothingWithoutARouteOrTraffic) {
  EXPECT_EQ(valueAt(20.0), 0.0);
  addCrossing(60.0, 0.0, 0.0);
  EXPECT_GT(valueAt(20.0), 0.0);
  world_.scene().route = nullptr;
  EXPECT_EQ(valueAt(20.0), 0.0);
}

}  // namespace
}  // namespace cdiff::guidance
