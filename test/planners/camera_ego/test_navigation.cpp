// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "map/lane_graph.h"
#include "planners/camera_ego/navigation.h"
#include "planners/course.h"
#include "support/network_text.h"

namespace cdiff::planners {
namespace {

/// 80 m to a junction, a left turn of radius 10 m in it (15.7 m), 80 m on.
struct LeftTurn {
  map::RoadNetwork network =
      testing::makeNetwork({{"in", testing::straight(0.0, 0.0, 80.0, 0.0)},
                            {":j", bend(), 13.89, true},
                            {"out", testing::straight(90.0, 10.0, 90.0, 90.0)}},
                           {{"in", "out", "", "M"}});
  map::Route route = testing::routeAlong(network, {"in", ":j", "out"});

  static testing::Points bend() {
    testing::Points points;
    for (int i = 0; i <= 18; ++i) {
      const double angle = core::degreesToRadians(5.0 * i);
      points.emplace_back(80.0 + 10.0 * std::sin(angle), 10.0 * (1.0 - std::cos(angle)), 0.0);
    }
    return points;
  }
};

TEST(Navigation, CommandsATurnFromFiftyMetersBeforeToItsEnd) {
  const LeftTurn turn;
  if (turn.route.junctionStretches().empty()) GTEST_FAIL() << "the course has no junction";
  const auto [begin, end] = turn.route.junctionStretches().front();
  const Navigation navigation(turn.network, turn.route);
  // A node every 50 m: at 50 m "follow", at about 80 m the turn.
  EXPECT_EQ(navigation.next(0.0).command, RoadCommand::kFollow);
  EXPECT_NEAR(navigation.next(0.0).arc_length, 50.0, 1e-9);
  EXPECT_EQ(navigation.next(46.1).command, RoadCommand::kLeft) << "50 m is nearer than 4 m";
  EXPECT_NEAR(navigation.next(60.0).position.x(), 80.0, 1.1);
  EXPECT_EQ(navigation.next(begin + 1.0).command, RoadCommand::kLeft) << "in the turn";
  EXPECT_NEAR(navigation.next(begin + 1.0).arc_length, end, 1e-9);
  EXPECT_EQ(navigation.next(end + 1.0).command, RoadCommand::kFollow);
  EXPECT_NEAR(navigation.next(1e6).arc_length, turn.route.length(), 1e-9);
}

/// 80 m along x, 20 m in a junction and 80 m on, turned by an angle [deg].
RoadCommand commandOfATurn(double degrees) {
  const double turn = core::degreesToRadians(degrees);
  const Eigen::Vector2d middle =
      Eigen::Vector2d(80.0, 0.0) + 20.0 * geometry::direction(0.5 * turn);
  const Eigen::Vector2d last = middle + 80.0 * geometry::direction(turn);
  const map::RoadNetwork network = testing::makeNetwork(
      {{"in", testing::straight(0.0, 0.0, 80.0, 0.0)},
       {":j", testing::straight(80.0, 0.0, middle.x(), middle.y()), 13.89, true},
       {"out", testing::straight(middle.x(), middle.y(), last.x(), last.y())}},
      {{"in", "out", "", "s"}});
  const map::Route route = testing::routeAlong(network, {"in", ":j", "out"});
  return Navigation(network, route).next(70.0).command;
}

TEST(Navigation, TurnsOfThirtyDegreesHaveASide) {
  EXPECT_EQ(commandOfATurn(35.0), RoadCommand::kLeft);
  EXPECT_EQ(commandOfATurn(-35.0), RoadCommand::kRight);
  EXPECT_EQ(commandOfATurn(25.0), RoadCommand::kStraight);
  EXPECT_EQ(commandOfATurn(-25.0), RoadCommand::kStraight);
}

// Nodes at the change and 10 m on; a node is passed 4 m before it.
TEST(Navigation, ALaneChangeIsCommandedForTenMeters) {
  const map::RoadNetwork network =
      test::NetworkText().edge("a", {"0,0 200,0", "0,4 200,4"}).network();
  const map::LaneGraph graph(network);
  for (const bool left : {true, false}) {
    const map::LanePosition start{network.findLane(left ? "a_0" : "a_1"), 5.0};
    const map::LanePosition goal{network.findLane(left ? "a_1" : "a_0"), 195.0};
    const map::Route route =
        graph.toRoute(graph.shortestPath(start, goal, 5000.0).value(), 5.0, 195.0);
    ASSERT_EQ(route.laneChanges().size(), 1U);
    const double place = route.laneChanges().front();
    const RoadCommand wanted = left ? RoadCommand::kChangeLeft : RoadCommand::kChangeRight;
    const Navigation navigation(network, route);
    EXPECT_NEAR(navigation.next(place - 4.1).arc_length, place, 1e-9);
    EXPECT_EQ(navigation.next(place - 4.1).command, wanted);
    EXPECT_NEAR(navigation.next(place - 3.9).arc_length, place + 10.0, 1e-9);
    EXPECT_EQ(navigation.next(place + 5.9).command, wanted);
    EXPECT_EQ(navigation.next(place + 6.1).command, RoadCommand::kFollow);
  }
}

// To the right on the first road and back to the left on the second: each by the lanes beside it.
TEST(Navigation, EachLaneChangeHasItsOwnSide) {
  const map::RoadNetwork network = test::NetworkText()
                                       .edge("a", {"0,0 200,0", "0,4 200,4"})
                                       .edge("b", {"200,0 400,0", "200,4 400,4"})
                                       .connection("a_0", "b_0")
                                       .connection("a_1", "b_1")
                                       .network();
  const map::LaneGraph graph(network);
  std::vector<map::LaneIndex> lanes;
  for (const char* id : {"a_1", "a_0", "b_0", "b_1"}) lanes.push_back(network.findLane(id));
  const map::Route route = graph.toRoute({lanes, 390.0}, 5.0, 195.0);
  ASSERT_EQ(route.laneChanges().size(), 2U);
  const Navigation navigation(network, route);
  EXPECT_EQ(navigation.next(route.laneChanges()[0] - 4.1).command, RoadCommand::kChangeRight);
  EXPECT_EQ(navigation.next(route.laneChanges()[1] - 4.1).command, RoadCommand::kChangeLeft);
}

TEST(Navigation, IsKeptForARouteAndFollowsThePlace) {
  const map::RoadNetwork network =
      testing::makeNetwork({{"road", testing::straight(0.0, 0.0, 220.0, 0.0)},
                            {"side", testing::straight(220.0, 0.0, 220.0, 90.0)}},
                           {{"road", "side", ""}});
  const map::Route route = testing::routeAlong(network, {"road"});
  NavigationFollower follower;
  // A node every 50 m and one at the end, each passed 4 m before it.
  for (double x = 1.0; x < 206.0; x += 5.0) {
    const double node = x < 45.5 ? 50.0 : x < 95.5 ? 100.0 : x < 145.5 ? 150.0 : 200.0;
    EXPECT_NEAR(follower.next(network, route, {x, 0.5}).arc_length, x < 195.5 ? node : 220.0, 1e-9)
        << x;
  }
  const map::Route longer = testing::routeAlong(network, {"road", "side"});
  EXPECT_NEAR(follower.next(network, longer, {205.0, 0.5}).arc_length, 250.0, 1e-9);
}

TEST(Navigation, CommandsHaveNames) {
  const char* names[] = {"left", "right", "straight", "follow", "change_left", "change_right"};
  for (std::int64_t i = 0; i < kRoadCommands; ++i) {
    EXPECT_STREQ(toText(static_cast<RoadCommand>(i)), names[i]);
  }
}

}  // namespace
}  // namespace cdiff::planners
