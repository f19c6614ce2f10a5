// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "session/protocol.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"

namespace cdiff::session {
namespace {

using traffic::SessionStatus;

/// A straight road of 100 m and a route along all of it.
class Protocol : public testing::Test {
 protected:
  static map::RoadNetwork makeNetwork() {
    return test::NetworkText().edge("a", {"0,0 100,0"}).network();
  }
  static std::vector<Eigen::Vector3d> points() {
    std::vector<Eigen::Vector3d> points;
    for (int x = 0; x <= 100; ++x) points.emplace_back(x, 0.0, 0.0);
    return points;
  }
  SessionStatus at(double x, double y, double speed) {
    const auto snapshot = test::snapshotWithEgo(tick_++, {x, y, 0.0, speed});
    return monitor_.update(snapshot);
  }

  map::RoadNetwork network_ = makeNetwork();
  map::Route route_ = map::matchRoute(network_, points());
  ProtocolMonitor monitor_{ProtocolOptions{}, route_};
  std::uint64_t tick_ = 0;
};

// 99 % of 100 m and within 10 m of the end: complete at x = 99, not at 98.9.
TEST_F(Protocol, CompletedNearTheEnd) {
  SessionStatus status = SessionStatus::kRunning;
  double x = 0.0;
  while (status == SessionStatus::kRunning && x < 98.0) status = at(x += 1.0, 0.0, 10.0);
  EXPECT_EQ(at(98.9, 0.0, 10.0), SessionStatus::kRunning);
  EXPECT_EQ(at(99.0, 0.0, 10.0), SessionStatus::kCompleted);
}

TEST_F(Protocol, NotCompletedBesideTheEnd) {
  for (double x = 1.0; x < 110.0; x += 1.0)
    ASSERT_EQ(at(x, 12.0, 10.0), SessionStatus::kRunning) << x;
}

// Ticks of 0.05 s: standing since tick 0, 3 s are over at tick 60.
TEST_F(Protocol, BlockedAfterThreeSeconds) {
  for (int i = 0; i < 60; ++i) ASSERT_EQ(at(0.0, 0.0, 0.05), SessionStatus::kRunning) << i;
  EXPECT_EQ(at(0.0, 0.0, 0.05), SessionStatus::kBlocked);
}

// Standing is slower than 0.1 m/s; 0.1 m/s is driving, for 5 s as well.
TEST_F(Protocol, NotBlockedAtTheSpeedItself) {
  for (int i = 0; i < 100; ++i) ASSERT_EQ(at(0.0, 0.0, 0.1), SessionStatus::kRunning) << i;
}

TEST_F(Protocol, MovingResetsTheBlockedClock) {
  for (int i = 0; i < 50; ++i) at(0.0, 0.0, 0.0);
  EXPECT_EQ(at(0.1, 0.0, 0.2), SessionStatus::kRunning);
  for (int i = 0; i < 60; ++i) ASSERT_EQ(at(0.1, 0.0, 0.0), SessionStatus::kRunning) << i;
  EXPECT_EQ(at(0.1, 0.0, 0.0), SessionStatus::kBlocked);
}

// Standing since tick 0: 3 s are over at tick 60, but only tick 65 may say so.
TEST_F(Protocol, BlockedIsWithheldAndItsTimeCountsOn) {
  EXPECT_FALSE(monitor_.standingSince());
  monitor_.withholdBlocked(true);
  for (int i = 0; i < 65; ++i) ASSERT_EQ(at(0.0, 0.0, 0.0), SessionStatus::kRunning) << i;
  EXPECT_EQ(monitor_.standingSince(), 0.0);
  monitor_.withholdBlocked(false);
  EXPECT_EQ(at(0.0, 0.0, 0.0), SessionStatus::kBlocked);
  EXPECT_EQ(at(0.1, 0.0, 0.2), SessionStatus::kRunning);
  EXPECT_FALSE(monitor_.standingSince());
}

TEST_F(Protocol, DeviatedBeyondThirtyMeters) {
  EXPECT_EQ(at(1.0, 30.0, 5.0), SessionStatus::kRunning);
  EXPECT_EQ(at(1.0, 30.1, 5.0), SessionStatus::kDeviated);
}

// 30 % of 100 m: progress made 15 m off the route from x = 10 m on has used it up beyond x = 40 m.
TEST_F(Protocol, DeviatedAfterThirtyPercentFifteenMetersAway) {
  EXPECT_EQ(at(10.0, 0.0, 5.0), SessionStatus::kRunning);
  for (int x = 11; x <= 40; ++x) ASSERT_EQ(at(x, 15.0, 5.0), SessionStatus::kRunning) << x;
  EXPECT_EQ(at(41.0, 14.9, 5.0), SessionStatus::kRunning);  // near enough not to count
  EXPECT_EQ(at(42.0, 15.0, 5.0), SessionStatus::kDeviated);
}

// 10 % of the lane's 10 m/s: every meter allows 1 s more.
TEST_F(Protocol, TheTimeLimitGrowsWithTheProgress) {
  ProtocolOptions options;
  options.time_limit = 5.0;
  options.time_limit_speed_percent = 10.0;
  EXPECT_NEAR(longestTime(options, route_), 105.0, 1e-9);
  ProtocolMonitor monitor(options, route_);
  EXPECT_EQ(monitor.update(test::snapshotWithEgo(99, {3.0, 0.0, 0.0, 5.0})),
            SessionStatus::kRunning);
  // 3 m allow 8 s, 160 ticks.
  EXPECT_EQ(monitor.update(test::snapshotWithEgo(159, {3.0, 0.0, 0.0, 5.0})),
            SessionStatus::kRunning);
  EXPECT_EQ(monitor.update(test::snapshotWithEgo(160, {3.0, 0.0, 0.0, 5.0})),
            SessionStatus::kTimedOut);
  options.time_limit_speed_percent = 0.0;
  EXPECT_EQ(longestTime(options, route_), 5.0);
}

// 40 s at 0.05 s a tick are 800 ticks.
TEST_F(Protocol, TimedOutAtFortySeconds) {
  tick_ = 799;
  EXPECT_EQ(at(1.0, 0.0, 5.0), SessionStatus::kRunning);
  EXPECT_EQ(at(1.0, 0.0, 5.0), SessionStatus::kTimedOut);
}

TEST_F(Protocol, ContactEndsOnlyWhenAsked) {
  traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(0, {1.0, 0.0, 0.0, 5.0});
  snapshot.contacts.push_back({"bg_1", "ego"});
  EXPECT_EQ(monitor_.update(snapshot), SessionStatus::kRunning);
  ProtocolOptions strict;
  strict.end_on_collision = true;
  ProtocolMonitor monitor(strict, route_);
  EXPECT_EQ(monitor.update(snapshot), SessionStatus::kCollided);
}

TEST_F(Protocol, MissingEgoIsAnError) {
  EXPECT_EQ(monitor_.update(traffic::TrafficSnapshot{}), SessionStatus::kError);
}

}  // namespace
}  // namespace cdiff::session
