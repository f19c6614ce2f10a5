// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/camera_ego/waypoint_controller.h"

namespace cdiff::planners {
namespace {

/// With the published gains of the steering.
WaypointController published() {
  WaypointControllerOptions options;
  options.pids.turn = {0.75, 0.75, 0.3};
  return WaypointController(options);
}

/// Waypoints every `step` meters along a direction.
EgoWaypoints straightOn(double step, double x = 1.0, double y = 0.0) {
  EgoWaypoints places;
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = static_cast<double>(i + 1) * step * Eigen::Vector2d(x, y);
  return places;
}

const Eigen::Vector2d kAhead(30.0, 0.0);

// Segments of 4 m in 0.5 s are 8 m/s; at 7.9 m/s the error is 0.1: 5 x 0.1 + 0.5 x 0.1 / 40 + 0.1.
TEST(WaypointController, DrivesAsFastAsItsSegments) {
  EXPECT_DOUBLE_EQ(desiredSpeed(straightOn(4.0)), 8.0);
  WaypointController controller({});
  const traffic::ControlAction action = controller.track(7.9, straightOn(4.0), kAhead);
  EXPECT_NEAR(action.throttle, 0.60125, 1e-9);
  EXPECT_EQ(action.brake, 0.0);
  EXPECT_NEAR(action.steer, 0.0, 1e-12);
}

TEST(WaypointController, BrakesWhereThePlanStandsOrIsTenPercentSlower) {
  EXPECT_EQ(WaypointController({}).track(3.0, straightOn(0.1), kAhead).brake, 1.0);
  EXPECT_EQ(WaypointController({}).track(8.9, straightOn(4.0), kAhead).brake, 1.0);
  EXPECT_EQ(WaypointController({}).track(8.7, straightOn(4.0), kAhead).brake, 0.0);
  EXPECT_EQ(WaypointController({}).track(8.9, straightOn(4.0), kAhead).throttle, 0.0);
}

// Waypoints to 45 degrees left: 0.5 of a right angle; the target beside them bears more. 0.75 +
// 0.75 / 40 + 0.3 = 1.06875 times 0.5, by the published gain.
TEST(WaypointController, SteersAtTheWaypointsAndWhileBrakingToo) {
  const Eigen::Vector2d target(20.0, 40.0);
  EXPECT_NEAR(published().track(8.0, straightOn(4.0, 0.7071068, 0.7071068), target).steer,
              0.5 * 1.06875, 1e-6);
  const auto braking = published().track(20.0, straightOn(4.0, 0.7071068, 0.7071068), target);
  EXPECT_EQ(braking.brake, 1.0);
  EXPECT_NEAR(braking.steer, 0.5 * 1.06875, 1e-6);
}

// The segments of 4 m have their middles at 6, 10 ... m: the first is nearest to 4 m, and its begin
// is the first waypoint. With segments of 1 m those are at 1.5, 2.5, 3.5, 4.5 and 5.5 m: 3.5 m
// and 4.5 m are as near, the first counts, which begins at the third waypoint.
TEST(WaypointController, AimsAtTheBeginOfTheSegmentAtFourMeters) {
  EgoWaypoints bent = straightOn(1.0);
  bent[2] = {3.0, 0.3};
  const double angle = std::atan2(0.3, 3.0) / (0.5 * 3.14159265358979);
  EXPECT_NEAR(published().track(2.0, bent, {10.0, 30.0}).steer, 1.06875 * angle, 1e-6);
}

TEST(WaypointController, TakesTheTargetWhereItBearsLessOrIsAnOutlier) {
  const EgoWaypoints left = straightOn(4.0, 0.7071068, 0.7071068);
  EXPECT_NEAR(published().track(8.0, left, kAhead).steer, 0.0, 1e-12) << "bears less";
  // Straight ahead, but the target lies at 90 degrees right, less than 10 m ahead.
  EXPECT_NEAR(published().track(8.0, straightOn(4.0), {0.0, -8.0}).steer, -1.0, 1e-12);
  EXPECT_NEAR(published().track(8.0, straightOn(4.0), {12.0, -40.0}).steer, 0.0, 1e-12)
      << "too far ahead";
}

}  // namespace
}  // namespace cdiff::planners
