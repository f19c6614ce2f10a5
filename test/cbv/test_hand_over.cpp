// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Whom the identification does not take over: who waits in the ego's queue, and who is about to
// touch another vehicle, whoever drives.
#include <gtest/gtest.h>

#include "cbv/candidate_gates.h"
#include "cbv/crossing_world.h"
#include "cbv/hand_over.h"

namespace cdiff::cbv {
namespace {

constexpr std::uint64_t kFirst = 52;  // 2.6 s

traffic::Vehicle onTheEgosLane(const std::string& id, double x, double speed) {
  return test::vehicle(id, {x, 0.0, 0.0, speed});
}

TEST(HandOver, WhoStandsInTheEgosQueueIsNoCbv) {
  for (const double speed : {0.0, 0.4, 0.6}) {
    CrossingWorld world;
    const CbvSelection selection =
        world.selector.update(crossingSnapshot(kFirst, 70.0, {onTheEgosLane("a", 85.0, speed)}));
    EXPECT_EQ(reasonOf(selection, "a") == kQueued, speed < 0.5) << speed;
  }
  CbvOptions options;
  options.queue_speed = 0.0;
  CrossingWorld world(options);
  const CbvSelection selection =
      world.selector.update(crossingSnapshot(kFirst, 70.0, {onTheEgosLane("a", 85.0, 0.0)}));
  EXPECT_NE(reasonOf(selection, "a"), kQueued);
}

TEST(HandOver, WhoStandsOnAnotherLaneMayBeCritical) {
  CrossingWorld world;
  const CbvSelection selection =
      world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 0.0)}));
  ASSERT_EQ(selection.assignments.size(), 1u);
}

// At 9 m/s a vehicle 4.5 m long reaches one that stands 8 m ahead in 0.39 s; it has 15.5 m to one
// 20 m ahead. Once that contact is no longer ahead it is taken.
TEST(HandOver, AVehicleWithAContactAheadIsNotTakenOver) {
  CrossingWorld world;
  const auto update = [&](std::uint64_t tick, double leader) {
    return world.selector.update(crossingSnapshot(
        tick, 70.0, {fromSouth("a", -40.0, 9.0), fromSouth("leader", leader, 0.0)}));
  };
  CbvSelection selection = update(kFirst, -32.0);
  EXPECT_EQ(reasonOf(selection, "a"), kContactAhead);
  EXPECT_GT(selection.rejected.front().interaction_score, 0.0);
  selection = update(kFirst + 4, -20.0);
  ASSERT_FALSE(selection.assignments.empty());
  EXPECT_EQ(selection.assignments.front().vehicle_id, "a");
}

TEST(HandOver, WithoutAClearTimeOnlyAContactNowCounts) {
  CbvOptions options;
  options.clear_time = 0.0;
  CrossingWorld world(options);
  const CbvSelection selection = world.selector.update(crossingSnapshot(
      kFirst, 70.0, {fromSouth("a", -40.0, 9.0), fromSouth("leader", -32.0, 0.0)}));
  EXPECT_EQ(reasonOf(selection, "a"), "");
}

/// A vehicle at the origin, and another beside it, 3 m to the left and `ahead` m ahead.
struct Beside {
  Motion handed_over{test::vehicle("a", {0.0, 0.0, 0.0, 10.0})};
  std::vector<Motion> others;
  explicit Beside(double ahead, double speed)
      : others{{test::vehicle("b", {ahead, 3.0, 0.0, speed})}} {}
};

TEST(HandOver, AContactMayLieOnThePathOrBehindABrakingVehicle) {
  const geometry::Polyline into_its_lane({{0, 0, 0}, {4, 1.5, 0}, {8, 3, 0}, {40, 3, 0}});
  Beside beside(-8.0, 10.0);
  EXPECT_FALSE(contactAhead(beside.handed_over, beside.others, 1.0)) << "straight on";
  beside.handed_over.path = &into_its_lane;
  // It goes 10 m in a second, 8 m if it brakes, and is 6.6 m or 4.6 m ahead of the other: they are
  // 4.5 m long.
  EXPECT_FALSE(contactAhead(beside.handed_over, beside.others, 0.9));
  EXPECT_TRUE(contactAhead(beside.handed_over, beside.others, 1.3)) << "if it brakes";
}

TEST(HandOver, AnotherLevelIsNoContact) {
  Beside beside(0.0, 10.0);
  beside.others.front().vehicle.state.position.y() = 0.0;
  EXPECT_TRUE(contactAhead(beside.handed_over, beside.others, 0.0));
  beside.others.front().vehicle.state.elevation = 5.0;
  EXPECT_FALSE(contactAhead(beside.handed_over, beside.others, 1.0));
}

TEST(HandOver, ABrakingVehicleStandsInTheEnd) {
  const Motion motion{test::vehicle("a", {0.0, 0.0, 0.0, 4.0})};
  EXPECT_NEAR(motion.boxAfter(1.0).center.x(), 4.0, 1e-9);
  EXPECT_NEAR(motion.boxAfter(0.5, 4.0).center.x(), 1.5, 1e-9);
  EXPECT_NEAR(motion.boxAfter(1.0, 4.0).center.x(), 2.0, 1e-9);
  EXPECT_NEAR(motion.boxAfter(3.0, 4.0).center.x(), 2.0, 1e-9);
}

}  // namespace
}  // namespace cdiff::cbv
