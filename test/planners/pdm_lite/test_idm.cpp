// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/pdm_lite/idm.h"

namespace cdiff::planners {
namespace {

IdmObstacle standingLeader(double distance) {
  IdmObstacle obstacle;
  obstacle.distance = distance;
  obstacle.length = 4.9;
  return obstacle;
}

TEST(Idm, SlowsBehindAStandingLeaderAsPublished) {
  // v = v0 = 8 m/s, leader 4.9 m long and standing; the published constants give these speeds (two
  // decimals).
  EXPECT_NEAR(idmSpeed(8.0, 8.0, standingLeader(15.0)), 7.25, 0.005);
  EXPECT_NEAR(idmSpeed(8.0, 8.0, standingLeader(12.0)), 6.57, 0.005);
  EXPECT_NEAR(idmSpeed(8.0, 8.0, standingLeader(10.0)), 5.49, 0.006);
  EXPECT_NEAR(idmSpeed(8.0, 8.0, standingLeader(9.0)), 4.51, 0.005);
}

TEST(Idm, AcceleratesFromRestOnAFreeRoad) {
  // dv/dt = 24 (1 - (v/8)^4) with v <= 1.2: v = 24 x 0.05 less at most 24 x 0.05 x (1.2/8)^4 =
  // 0.0006.
  const double speed = idmSpeed(0.0, 8.0, standingLeader(10000.0));
  EXPECT_LT(speed, 1.2);
  EXPECT_GT(speed, 1.1994);
}

TEST(Idm, StandsAtTheMinimumGap) {
  // At rest s* = s0: dv/dt = 0 for s = 4 m, that is d = 8.9 m; nearer it would be negative.
  EXPECT_NEAR(idmSpeed(0.0, 8.0, standingLeader(8.9)), 0.0, 1e-12);
  EXPECT_EQ(idmSpeed(0.0, 8.0, standingLeader(8.8)), 0.0);
  EXPECT_GT(idmSpeed(0.0, 8.0, standingLeader(9.0)), 0.0);
}

// Behind a leader as fast as it, at the gap s* = s0 + v T = 4 + 8 x 0.25 = 6 m: dv/dt = -24 (8 /
// 20)^4 = -0.614 m/s^2 at first, less as s* shrinks with v. Euler's method in steps of 10 us
// gives 7.97334 m/s after 0.05 s.
TEST(Idm, FollowsALeaderOfItsOwnSpeedAtTheWantedGap) {
  IdmObstacle leader = standingLeader(6.0 + 4.9);
  leader.speed = 8.0;
  EXPECT_NEAR(idmSpeed(8.0, 20.0, leader), 7.97334, 1e-5);
}

// 20 m behind a standing leader b is 8.7 m/s^2 up to 6.02 m/s and 3.72 m/s^2 above; Euler's method
// in steps of 10 us. With the other b each would be 0.05 m/s off.
TEST(Idm, BrakesLessHardAboveSixMetersPerSecond) {
  EXPECT_NEAR(idmSpeed(6.02, 8.0, standingLeader(20.0)), 6.50532, 1e-4);
  EXPECT_NEAR(idmSpeed(6.03, 8.0, standingLeader(20.0)), 6.46470, 1e-4);
}

TEST(Idm, NeverAsksForReverse) { EXPECT_EQ(idmSpeed(8.0, 8.0, standingLeader(5.0)), 0.0); }

TEST(Idm, DesiredSpeedZeroStops) { EXPECT_EQ(idmSpeed(3.0, 0.0, standingLeader(100.0)), 0.0); }

}  // namespace
}  // namespace cdiff::planners
