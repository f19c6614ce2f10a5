// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The search for the latest take-over, and which contacts speak against a driver.
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "session/scripted_session.h"
#include "support/snapshot_builder.h"
#include "what_if/take_over.h"

namespace cdiff::what_if {
namespace {

TEST(Driver, TheDefaultIsAPlannerOfTheTable) {
  EXPECT_NE(planners::findPlanner(DriverChoice().planner), nullptr);
}

TEST(LatestAvoiding, IsTheSmallestThatAvoids) {
  for (int latest = 1; latest <= 28; ++latest) {
    const auto found = latestAvoiding(28, [&](int steps) {
      EXPECT_GT(steps, 0);
      EXPECT_LE(steps, 28);
      return steps >= latest;
    });
    EXPECT_EQ(found, latest);
  }
}

TEST(LatestAvoiding, IsFoundThoughEarlierTakeOversFail) {
  EXPECT_EQ(latestAvoiding(50, [](int steps) { return steps >= 8 && steps <= 12; }), 8);
}

TEST(LatestAvoiding, IsNoneWhereEachFails) {
  std::vector<int> asked;
  EXPECT_EQ(latestAvoiding(12, [&](int steps) { return asked.push_back(steps), false; }),
            std::nullopt);
  EXPECT_EQ(asked, (std::vector<int>{5, 10, 12}));
}

/// An ego at x = 100 m and 8 m/s, taken over at tick 10, followed to tick 40.
class FollowedCourse : public testing::Test {
 protected:
  /// The ego touches `other`, which is at `x` then, at a tick; nothing else happens.
  void touch(std::uint64_t tick, const std::string& id, double x, double speed) {
    for (const std::uint64_t now : {tick - 1, tick}) {
      traffic::TrafficSnapshot world = test::snapshotWithEgo(now, {100.0, 0.0, 0.0, 8.0});
      world.vehicles.push_back(test::vehicle(id, {x, 0.0, 0.0, speed}));
      if (now == tick)
        world.contacts = {{std::min<std::string>(traffic::kEgoId, id),
                           std::max<std::string>(traffic::kEgoId, id)}};
      session::TickRecord record;
      record.snapshot = &world;
      follower_.observe(record);
    }
  }
  test::ScriptedSession session_;
  CourseFollower follower_{session_.setup(), {10, 40, "attacker"}, std::nullopt};
};

TEST_F(FollowedCourse, ContactsBeforeTheTakeOverDoNotCount) {
  touch(8, "attacker", 104, 0);
  EXPECT_FALSE(follower_.course().contact);
  EXPECT_FALSE(follower_.stop());
}

TEST_F(FollowedCourse, WhoRunsIntoItsRearIsCountedApart) {
  touch(12, "follower", 96, 12);
  EXPECT_FALSE(follower_.course().contact);
  EXPECT_EQ(follower_.course().struck_behind, 1U);
  EXPECT_FALSE(follower_.stop());
}

TEST_F(FollowedCourse, ThePartnerCountsAlsoAtItsRear) {
  touch(12, "attacker", 96, 12);
  ASSERT_TRUE(follower_.course().contact);
  EXPECT_EQ(follower_.course().contact->ego_side, "rear");
  EXPECT_TRUE(follower_.stop());
}

TEST_F(FollowedCourse, AnotherVehicleInFrontCounts) {
  touch(12, "other", 104, 0);
  ASSERT_TRUE(follower_.course().contact);
  EXPECT_EQ(follower_.course().contact->partner, "other");
}

TEST_F(FollowedCourse, NothingIsSeenAfterTheEnd) {
  touch(42, "attacker", 104, 0);
  EXPECT_FALSE(follower_.course().contact);
}

}  // namespace
}  // namespace cdiff::what_if
