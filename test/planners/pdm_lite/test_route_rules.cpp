// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/course.h"
#include "planners/pdm_lite/route_rules.h"
#include "planning/route_follower.h"

namespace cdiff::planners {
namespace {

using testing::leftBend;
using testing::makeNetwork;
using testing::Points;
using testing::routeAlong;
using testing::straight;
using testing::vehicleAt;

traffic::VehicleState stateAt(double x, double y, double heading_degrees) {
  return vehicleAt("", x, y, core::degreesToRadians(heading_degrees), 5.0).state;
}

class StraightRoad : public ::testing::Test {
 protected:
  map::RoadNetwork network_ = makeNetwork({{"road", straight(0.0, 0.0, 200.0, 0.0), 10.0}});
  map::Route route_ = routeAlong(network_, {"road"});
};

TEST_F(StraightRoad, InitialSpeedIsTheSmallestOfThree) {
  PdmLiteOptions options;
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route_, 10.0, 5.0, 8.0), 7.2);  // 0.72 x 10
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route_, 10.0, 5.0, 6.0), 6.0);
  options.speed_limit_share = 1.5;
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route_, 10.0, 5.0, 20.0), 10.0);
}

TEST(RouteRules, OriginalConfigurationDrivesAtMost20MetersPerSecond) {
  const auto network = makeNetwork({{"fast", straight(0.0, 0.0, 200.0, 0.0), 40.0}});
  const map::Route route = routeAlong(network, {"fast"});
  PdmLiteOptions options;
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route, 10.0, 5.0, 100.0), 28.8);  // 0.72 x 40
  options.configuration = "original";
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route, 10.0, 5.0, 100.0), 20.0);
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route, 10.0, 5.0, 8.0), 8.0);
  options.top_speed = 15.0;
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route, 10.0, 5.0, 100.0), 15.0);
}

TEST_F(StraightRoad, LeaderIsNearTheRouteAheadAndAlongIt) {
  EXPECT_TRUE(isLeading(route_, 50.0, stateAt(70.0, 2.4, 34.0)));
  EXPECT_FALSE(isLeading(route_, 50.0, stateAt(70.0, 2.6, 0.0)));
  EXPECT_FALSE(isLeading(route_, 50.0, stateAt(70.0, 0.0, 36.0)));
  EXPECT_TRUE(isLeading(route_, 50.0, stateAt(129.0, 0.0, 0.0)));
  EXPECT_FALSE(isLeading(route_, 50.0, stateAt(133.0, 0.0, 0.0)));
  EXPECT_FALSE(isLeading(route_, 50.0, stateAt(45.0, 0.0, 0.0)));
}

TEST_F(StraightRoad, TrailerIsNearTheRouteBehindAndAlongIt) {
  EXPECT_TRUE(isTrailing(route_, 50.0, stateAt(40.0, 2.9, 29.0)));
  EXPECT_FALSE(isTrailing(route_, 50.0, stateAt(40.0, 3.1, 0.0)));
  EXPECT_FALSE(isTrailing(route_, 50.0, stateAt(40.0, 0.0, 31.0)));
  EXPECT_FALSE(isTrailing(route_, 50.0, stateAt(56.0, 0.0, 0.0)));
  // The route starts at 0: behind it goes straight on.
  EXPECT_TRUE(isTrailing(route_, 0.0, stateAt(-20.0, 1.0, 0.0)));
}

TEST(RouteRules, JunctionCapCounts30MetersAhead) {
  const auto network = makeNetwork({{"in", straight(0.0, 0.0, 100.0, 0.0), 50.0},
                                    {":j_0", straight(100.0, 0.0, 110.0, 0.0), 50.0, true},
                                    {"out", straight(110.0, 0.0, 200.0, 0.0), 50.0}},
                                   {{"in", ":j_0", ""}, {":j_0", "out", ""}});
  const map::Route route = routeAlong(network, {"in", ":j_0", "out"});
  const PdmLiteOptions options;
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route, 69.0, 0.0, 100.0), 36.0);
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route, 71.0, 0.0, 100.0), 64.0 / 3.6);
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route, 105.0, 0.0, 100.0), 64.0 / 3.6);
  EXPECT_DOUBLE_EQ(initialTargetSpeed(options, route, 113.0, 0.0, 100.0), 36.0);
}

TEST(RouteRules, SlowerLaneIsAnticipatedWithinTheBrakingDistance) {
  const auto network = makeNetwork({{"fast", straight(0.0, 0.0, 100.0, 0.0), 10.0},
                                    {"slow", straight(100.0, 0.0, 200.0, 0.0), 5.0}},
                                   {{"fast", "slow", ""}});
  const map::Route route = routeAlong(network, {"fast", "slow"});
  // 8 m/s: 64 / 8 = 8 m ahead.
  EXPECT_DOUBLE_EQ(initialTargetSpeed({}, route, 91.0, 8.0, 8.0), 7.2);
  EXPECT_DOUBLE_EQ(initialTargetSpeed({}, route, 93.0, 8.0, 8.0), 3.6);
}

TEST(RouteRules, LaneChangeIsNear20MetersAheadAnd15Behind) {
  const std::string xml =
      "<net><edge id=\"road\"><lane id=\"road_0\" index=\"0\" speed=\"10\" shape=\"0,0 200,0\"/>"
      "<lane id=\"road_1\" index=\"1\" speed=\"10\" shape=\"0,3.2 200,3.2\"/></edge></net>";
  const auto network = map::RoadNetwork::fromText(xml, "two lanes");
  Points points;
  std::vector<map::LaneIndex> lanes;
  for (int x = 0; x <= 200; ++x) {
    points.emplace_back(x, x < 100 ? 0.0 : 3.2, 0.0);
    lanes.push_back(network.findLane(x < 100 ? "road_0" : "road_1"));
  }
  const map::Route route(network, points, lanes);
  ASSERT_EQ(route.laneChanges().size(), 1u);
  const double change = route.laneChanges().front();
  EXPECT_TRUE(nearLaneChange(route, change - 19.0, 5.0));
  EXPECT_FALSE(nearLaneChange(route, change - 21.0, 5.0));
  EXPECT_TRUE(nearLaneChange(route, change + 14.0, 5.0));
  EXPECT_FALSE(nearLaneChange(route, change + 16.0, 5.0));
  // 20 m/s: 72 km/h, 7.2^2 / 2 + 10 = 35.9 m.
  EXPECT_TRUE(nearLaneChange(route, change - 35.0, 20.0));
  EXPECT_FALSE(nearLaneChange(route, change - 36.5, 20.0));
  // A trailer 5 m to the side counts only after a lane change.
  EXPECT_TRUE(isTrailing(route, change + 10.0, stateAt(90.0, -5.0, 0.0)));
  EXPECT_FALSE(isTrailing(route, change + 40.0, stateAt(130.0, -2.0, 0.0)));
}

TEST(RouteRules, RedLightIsMeasuredToItsStopLine) {
  const auto network = makeNetwork(
      {{"in", straight(0.0, 0.0, 100.0, 0.0)}, {"out", straight(100.0, 0.0, 200.0, 0.0)}},
      {{"in", "out", "light"}});
  const map::Route route = routeAlong(network, {"in", "out"});
  traffic::TrafficSnapshot snapshot;
  EXPECT_FALSE(distanceToRedLight(route, 60.0, snapshot));
  for (const std::string red : {"r", "y", "u", "s"}) {
    snapshot.signals = {{"light", red}};
    const auto distance = distanceToRedLight(route, 60.0, snapshot);
    ASSERT_TRUE(distance) << red;
    EXPECT_NEAR(*distance, 40.0, 1e-9);
  }
  for (const std::string free : {"G", "g", "o", "O"}) {
    snapshot.signals = {{"light", free}};
    EXPECT_FALSE(distanceToRedLight(route, 60.0, snapshot)) << free;
  }
  snapshot.signals = {{"light", "r"}};
  EXPECT_FALSE(distanceToRedLight(route, 100.5, snapshot));
}

/// Three roads with stop signs between them, 25 and 8 m apart.
class StopSigns : public ::testing::Test {
 protected:
  /// What the rule says where the next line is so far away.
  std::optional<double> before(double line, double distance, double speed) {
    return rule_.distance(route_, line - distance, speed);
  }

  map::RoadNetwork network_ =
      makeNetwork({{"a", straight(0.0, 0.0, 50.0, 0.0)},
                   {"b", straight(50.0, 0.0, 75.0, 0.0)},
                   {"c", straight(75.0, 0.0, 83.0, 0.0)},
                   {"d", straight(83.0, 0.0, 200.0, 0.0)}},
                  {{"a", "b", "", "s"}, {"b", "c", "", "w"}, {"c", "d", "", "s"}});
  map::Route route_ = routeAlong(network_, {"a", "b", "c", "d"});
  StopSignRule rule_;
};

TEST_F(StopSigns, AreClearedByStandingLessThan3MetersBeforeTheLine) {
  EXPECT_DOUBLE_EQ(before(50.0, 40.0, 8.0).value(), 40.0);
  EXPECT_DOUBLE_EQ(before(50.0, 3.1, 0.0).value(), 3.1);
  EXPECT_DOUBLE_EQ(before(50.0, 2.9, 0.11).value(), 2.9);
  EXPECT_FALSE(before(50.0, 2.9, 0.09));
  EXPECT_FALSE(before(50.0, 1.0, 5.0)) << "it stays cleared";
}

TEST_F(StopSigns, CountAgainOnceTheNextIsFartherThan10Meters) {
  ASSERT_FALSE(before(50.0, 2.0, 0.0));
  EXPECT_DOUBLE_EQ(before(75.0, 24.0, 3.0).value(), 24.0);
  EXPECT_DOUBLE_EQ(before(75.0, 9.0, 3.0).value(), 9.0);
  ASSERT_FALSE(before(75.0, 2.0, 0.0));
  EXPECT_FALSE(before(83.0, 7.9, 3.0)) << "the next sign is too near to be armed";
  EXPECT_FALSE(before(200.0, 50.0, 3.0)) << "no sign ahead";
}

TEST(RouteRules, BicyclesAreToldByTheirWidth) {
  EXPECT_TRUE(isBicycle({1.6, 0.65, 1.7}));
  EXPECT_FALSE(isBicycle({2.1, 0.8, 1.7}));  // SUMO's moped
  EXPECT_FALSE(isBicycle({4.5, 1.8, 1.5}));
}

TEST(RouteFollower, GoesStraightOnBeyondTheEnds) {
  const auto network = makeNetwork({{"bend", leftBend(20.0, 12.0, 20.0)}});
  const map::Route route = routeAlong(network, {"bend"});
  EXPECT_TRUE(route.path().extendedPoseAt(-5.0).position.isApprox(Eigen::Vector2d(-5.0, 0.0)));
  const Eigen::Vector2d end = route.path().extendedPoseAt(route.length() + 4.0).position;
  EXPECT_NEAR(end.x(), 32.0, 1e-9);
  EXPECT_NEAR(end.y(), 36.0, 1e-9);
  planning::RouteFollower follower;
  follower.update(route, {32.0, 30.0});
  follower.update(route, {32.0, 36.0});
  EXPECT_NEAR(follower.arcLength(), route.length() + 4.0, 1e-9);
}

TEST(RouteFollower, CatchesUpAfterAGapAsFarAsItMayReach) {
  const auto network = makeNetwork({{"road", {{0.0, 0.0, 0.0}, {200.0, 0.0, 0.0}}}});
  const map::Route route = routeAlong(network, {"road"});
  planning::RouteFollower follower;
  follower.update(route, {5.0, 0.0});
  follower.update(route, {65.0, 0.0});
  EXPECT_NEAR(follower.arcLength(), 20.0, 1e-9);
  follower.update(route, {65.0, 0.0}, 60.0);
  EXPECT_NEAR(follower.arcLength(), 65.0, 1e-9);
}

TEST(RouteFollower, FollowsARouteThatCrossesItselfInOrder) {
  // Along +x, round a square and back over the start along +y at (40, 0): the crossing lies at 40 m
  // and at 220 m.
  Points points = {{0.0, 0.0, 0.0},    {100.0, 0.0, 0.0},  {100.0, 30.0, 0.0}, {70.0, 30.0, 0.0},
                   {70.0, -30.0, 0.0}, {40.0, -30.0, 0.0}, {40.0, 50.0, 0.0}};
  const auto network = makeNetwork({{"loop", points}});
  const map::Route route = routeAlong(network, {"loop"});
  planning::RouteFollower follower;
  double last = 0.0;
  for (double s = 0.0; s <= route.length(); s += 0.8) {
    follower.update(route, route.path().positionAt(s));
    EXPECT_NEAR(follower.arcLength(), s, 1e-6);
    EXPECT_GE(follower.arcLength(), last);
    last = follower.arcLength();
  }
  // A step back does not undo progress.
  follower.update(route, route.path().positionAt(route.length() - 3.0));
  EXPECT_EQ(follower.arcLength(), last);
}

TEST(RouteFollower, StartsAgainOnAnotherRoute) {
  const auto network = makeNetwork(
      {{"east", straight(0.0, 0.0, 100.0, 0.0)}, {"north", straight(60.0, -10.0, 60.0, 90.0)}});
  const map::Route east = routeAlong(network, {"east"});
  const map::Route north = routeAlong(network, {"north"});
  planning::RouteFollower follower;
  follower.update(east, {60.0, 0.0});
  EXPECT_NEAR(follower.arcLength(), 60.0, 1e-9);
  follower.update(north, {60.0, 0.0});
  EXPECT_NEAR(follower.arcLength(), 10.0, 1e-9);
}

}  // namespace
}  // namespace cdiff::planners
