// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// On which lane a candidate is, and where a conflict point lies.
#include <gtest/gtest.h>

#include <cmath>

#include "cbv/candidate_gates.h"
#include "cbv/cbv_options.h"
#include "cbv/conflict_search.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"

namespace cdiff::cbv {
namespace {

const double kFork = core::radiansToDegrees(std::atan(0.2));  // [deg]

/// Two lanes that overlap where they part: "on" along x and "off", which leaves it to the left.
class Fork : public ::testing::Test {
 protected:
  LanePlacement placed(const test::Motion& motion, const std::string& lane_id = "") const {
    traffic::Vehicle vehicle = test::vehicle("a", motion);
    vehicle.lane_id = lane_id;
    return placeOnLane(network_, vehicle, {});
  }
  std::string laneOf(const test::Motion& motion, const std::string& lane_id = "") const {
    const LanePlacement placement = placed(motion, lane_id);
    return placement.reason == nullptr ? network_.lane(placement.place.lane).id : placement.reason;
  }

  map::RoadNetwork network_ =
      test::NetworkText().edge("on", {"0,0 100,0"}).edge("off", {"0,0 100,20"}).network();
};

TEST_F(Fork, TheLaneThatSumoNamesCountsWhereTheCenterLiesOnIt) {
  EXPECT_EQ(laneOf({5.0, 0.3}), "on_0");
  EXPECT_EQ(laneOf({5.0, 0.3}, "off_0"), "off_0");
  EXPECT_EQ(laneOf({90.0, 0.3}, "off_0"), "on_0") << "that lane is 17 m away";
}

// (5, 0.3) is 0.3 m from one lane and 5 sin - 0.3 cos = 0.686 m from the other; a radian counts as
// 2 m. Along the other lane 0.3 + 2 x 0.197 = 0.695 m against 0.686 m; at 0.15 rad 0.3 + 0.3 m
// against 0.686 + 2 x 0.047 m.
TEST_F(Fork, OtherwiseDistanceAndHeadingDecide) {
  EXPECT_EQ(laneOf({5.0, 0.3, kFork}), "off_0");
  EXPECT_EQ(laneOf({5.0, 0.3, core::radiansToDegrees(0.15)}), "on_0");
}

TEST_F(Fork, TheHeadingIsThatOfTheLaneWithinSixtyDegrees) {
  EXPECT_EQ(laneOf({50.0, 0.0, -59.0}), "on_0");
  EXPECT_EQ(laneOf({50.0, 0.0, -61.0}), kOffLane);
}

// Half a meter of it is left, so that a route can start with a lane change.
TEST_F(Fork, APlaceIsNeverAtTheEndOfItsLane) {
  EXPECT_NEAR(placed({99.0, 0.0}).place.arc_length, 99.0, 1e-9);
  EXPECT_NEAR(placed({99.9, 0.0}).place.arc_length, 99.5, 1e-9);
}

// The road climbs 1 m in 10 m; the candidate is 15 m behind the ego.
TEST(ConflictSearch, AConflictPointLiesOnTheRoadsHeight) {
  const map::RoadNetwork network = test::NetworkText().edge("road", {"0,0,0 300,0,30"}).network();
  const map::LaneGraph graph(network);
  const map::Route route = graph.toRoute({{0}, 300.0}, 0.0, 300.0);
  const CbvOptions options;
  const ConflictSearch search(options, graph, route);
  const EgoProgress ego{test::vehicle("ego", {60.0, 0.0, 0.0, 8.0, 6.0}).state, 60.0};
  const traffic::VehicleState candidate = test::vehicle("a", {45.0, 0.0, 0.0, 10.0, 4.5}).state;
  const ConflictResult found = search.find(candidate, {0, 45.0}, ego);
  ASSERT_TRUE(found.conflict.has_value());
  EXPECT_GT(found.conflict->point.position.x(), 60.0);
  EXPECT_NEAR(found.conflict->point.position.z(), 0.1 * found.conflict->point.position.x(), 1e-9);
}

}  // namespace
}  // namespace cdiff::cbv
