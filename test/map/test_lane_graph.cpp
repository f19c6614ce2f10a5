// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "map/lane_graph.h"
#include "support/network_text.h"

namespace cdiff::map {
namespace {

/// "a": two lanes of 100 m; the right one leads straight on through 20 m to "b" (80 m), the left
/// one turns left through an internal lane of 20 + 20 m to "c" (60 m northwards); "b" leads back to
/// "a" over the long internal lane ":k" (400 m).
test::NetworkText fork() {
  test::NetworkText text;
  text.edge("a", {"0,0 100,0", "0,4 100,4"}, "k", "j")
      .edge(":j_0", {"100,0 120,0"})
      .edge(":j_1", {"100,4 120,4 120,24"})
      .edge("b", {"120,0 200,0"}, "j", "k")
      .edge("c", {"120,24 120,84"}, "j", "e")
      .edge(":k_0", {"200,0 200,-100 0,-100 0,0"})
      .connection("a_0", "b_0", ":j_0_0")
      .connection("a_1", "c_0", ":j_1_0", 'l')
      .connection("b_0", "a_0", ":k_0_0");
  return text;
}

class LaneGraphTest : public ::testing::Test {
 protected:
  LaneIndex lane(const std::string& id) const { return network_.findLane(id); }
  std::vector<std::string> names(const LanePath& path) const {
    std::vector<std::string> ids;
    for (const LaneIndex index : path.lanes) ids.push_back(network_.lane(index).id);
    return ids;
  }
  RoadNetwork network_ = fork().network();
  LaneGraph graph_{network_};
};

using Names = std::vector<std::string>;

TEST_F(LaneGraphTest, GoesStraightToAGoalAheadOnTheSameLane) {
  const auto path = graph_.shortestPath({lane("a_0"), 20.0}, {lane("a_0"), 70.0}, 1000.0);
  ASSERT_TRUE(path.has_value());
  EXPECT_EQ(names(*path), Names{"a_0"});
  EXPECT_DOUBLE_EQ(path->length, 50.0);
}

TEST_F(LaneGraphTest, GoesRoundToAGoalBehind) {
  // 80 m to the end of a_0, 20 + 80 m, 100 + 200 + 100 m round, 10 m on a_0.
  const auto path = graph_.shortestPath({lane("a_0"), 20.0}, {lane("a_0"), 10.0}, 1000.0);
  ASSERT_TRUE(path.has_value());
  EXPECT_EQ(names(*path), (Names{"a_0", ":j_0_0", "b_0", ":k_0_0", "a_0"}));
  EXPECT_DOUBLE_EQ(path->length, 80.0 + 20.0 + 80.0 + 400.0 + 10.0);
  EXPECT_FALSE(graph_.shortestPath({lane("a_0"), 20.0}, {lane("a_0"), 10.0}, 589.0).has_value());
}

TEST_F(LaneGraphTest, ChangesLanesWithoutDrivenLength) {
  // From a_0 at 20 m to c_0 at 30 m: 80 + 40 + 30 m, the change itself costs nothing.
  const auto path = graph_.shortestPath({lane("a_0"), 20.0}, {lane("c_0"), 30.0}, 1000.0);
  ASSERT_TRUE(path.has_value());
  EXPECT_EQ(names(*path), (Names{"a_0", "a_1", ":j_1_0", "c_0"}));
  EXPECT_DOUBLE_EQ(path->length, 150.0);
  EXPECT_FALSE(
      graph_.shortestPath({lane("a_0"), 20.0}, {lane("c_0"), 30.0}, 1000.0, false).has_value());
  EXPECT_FALSE(graph_.shortestPath({lane("c_0"), 0.0}, {lane("a_0"), 30.0}, 1000.0).has_value());
}

TEST_F(LaneGraphTest, KeepsOffSlowLanesExceptAtTheEnds) {
  test::NetworkText text = fork();
  test::LaneText slow;
  slow.speed = 1.39;
  text.edge("p", {"120,84 120,100"}, "e", "f", slow).edge("q", {"120,100 120,120"}, "f", "g");
  text.connection("c_0", "p_0").connection("p_0", "q_0");
  const RoadNetwork network = text.network();
  const LaneGraph graph(network);
  const LaneIndex start = network.findLane("c_0");
  const LaneIndex parking = network.findLane("p_0");
  const LaneIndex beyond = network.findLane("q_0");
  EXPECT_TRUE(graph.shortestPath({start, 0.0}, {parking, 5.0}, 1000.0).has_value());
  EXPECT_FALSE(graph.shortestPath({start, 0.0}, {beyond, 5.0}, 1000.0).has_value());
  EXPECT_TRUE(graph.shortestPath({parking, 0.0}, {beyond, 5.0}, 1000.0).has_value());
}

TEST_F(LaneGraphTest, MeasuresToManyLanesAtOnce) {
  const std::vector<double> lengths = graph_.distancesFrom({lane("a_0"), 20.0}, 300.0);
  const auto at = [&](const std::string& id) {
    return lengths[static_cast<std::size_t>(lane(id))];
  };
  EXPECT_DOUBLE_EQ(at("a_1"), -20.0);  // abreast of the start
  EXPECT_DOUBLE_EQ(at(":j_0_0"), 80.0);
  EXPECT_DOUBLE_EQ(at("b_0"), 100.0);
  EXPECT_DOUBLE_EQ(at("c_0"), 120.0);
  EXPECT_DOUBLE_EQ(at(":k_0_0"), 180.0);
  EXPECT_TRUE(std::isinf(at("a_0")));  // 580 m round: beyond the limit
  const std::vector<double> far = graph_.distancesFrom({lane("a_0"), 20.0}, 600.0);
  EXPECT_DOUBLE_EQ(far[static_cast<std::size_t>(lane("a_0"))], 580.0);
  const std::vector<double> straight = graph_.distancesFrom({lane("a_0"), 20.0}, 300.0, false);
  EXPECT_TRUE(std::isinf(straight[static_cast<std::size_t>(lane("c_0"))]));
}

/// "a" eastwards to "b" (100 m each), and back on "d" and "e"; a car may turn round from "a" to "e"
/// inside ":j" (10 m), or go on to "b" and turn at its end inside ":k" (20 m) to "d".
test::NetworkText thereAndBack() {
  test::NetworkText text;
  text.edge("a", {"0,0 100,0"}, "i", "j")
      .edge("b", {"100,0 200,0"}, "j", "k")
      .edge("d", {"200,4 100,4"}, "k", "j")
      .edge("e", {"100,4 0,4"}, "j", "i")
      .edge(":j_0", {"100,0 105,2 100,4"})
      .edge(":k_0", {"200,0 209,2 200,4"})
      .connection("a_0", "b_0")
      .connection("d_0", "e_0")
      .connection("a_0", "e_0", ":j_0_0", 't')
      .connection("b_0", "d_0", ":k_0_0", 't');
  return text;
}

TEST(LaneGraphTurns, RoutesDoNotTurnRound) {
  const RoadNetwork network = thereAndBack().network();
  const LaneGraph graph(network);
  const LanePosition start{network.findLane("a_0"), 20.0};
  const LaneIndex back = network.findLane("e_0");
  EXPECT_TRUE(graph.shortestPath(start, {network.findLane("b_0"), 50.0}, 1000.0).has_value());
  EXPECT_FALSE(graph.shortestPath(start, {back, 50.0}, 1000.0).has_value());
  EXPECT_TRUE(std::isinf(graph.distancesFrom(start, 1000.0)[static_cast<std::size_t>(back)]));
  // Straight on to the end of "b", 180 m from the start, and not back from there.
  const auto path = graph.shortestPath(start, {network.findLane("b_0"), 50.0}, 1000.0);
  const Route longer = graph.extended(graph.toRoute(*path, 20.0, 50.0), 500.0);
  EXPECT_NEAR(longer.length(), 180.0, 1.0);
  // Who is turning already may finish.
  const LanePosition turning{network.findLane(":j_0_0"), 2.0};
  EXPECT_TRUE(graph.shortestPath(turning, {back, 50.0}, 1000.0).has_value());
}

TEST(LaneGraphTurns, RoutesTurnRoundWhereTheEgoDoes) {
  const RoadNetwork network = thereAndBack().network();
  const LaneGraph graph(network);
  LanePath turn;
  for (const char* id : {"a_0", ":j_0_0", "e_0"}) turn.lanes.push_back(network.findLane(id));
  const LaneGraph allowing = graph.allowingTurnsOf(graph.toRoute(turn, 10.0, 50.0));
  const LanePosition start{network.findLane("a_0"), 20.0};
  const auto path = allowing.shortestPath(start, {network.findLane("e_0"), 50.0}, 1000.0);
  ASSERT_TRUE(path.has_value());
  EXPECT_EQ(path->lanes, turn.lanes);
  // The turn at the end of "b" is not the ego's.
  EXPECT_FALSE(allowing.shortestPath(start, {network.findLane("d_0"), 50.0}, 1000.0).has_value());
}

TEST(LaneGraphTurns, NamesConnectionsThatTurnRound) {
  EXPECT_EQ(turnRoundText(thereAndBack().network()),
            "2 connections turn round (a_0 -> e_0, b_0 -> d_0); CBVs use those of the ego's route "
            "only");
  EXPECT_EQ(turnRoundText(fork().network()), "");
}

TEST_F(LaneGraphTest, PlacesPointsEveryMeterOnTheCenterLine) {
  const auto path = graph_.shortestPath({lane("a_0"), 20.0}, {lane("b_0"), 30.0}, 1000.0);
  const Route route = graph_.toRoute(*path, 20.0, 30.0);
  EXPECT_NEAR(route.length(), 130.0, 1e-9);
  ASSERT_EQ(route.path().points().size(), 131u);
  for (std::size_t i = 0; i < route.path().points().size(); ++i) {
    EXPECT_NEAR(route.path().points()[i].x(), 20.0 + static_cast<double>(i), 1e-9);
    EXPECT_NEAR(route.path().points()[i].y(), 0.0, 1e-9);
  }
  EXPECT_EQ(network_.lane(route.laneAt(79.5)).id, "a_0");
  EXPECT_EQ(network_.lane(route.laneAt(80.5)).id, ":j_0_0");
  EXPECT_EQ(network_.lane(route.laneAt(130.0)).id, "b_0");
}

TEST_F(LaneGraphTest, BlendsLaneChanges) {
  const auto path = graph_.shortestPath({lane("a_0"), 20.0}, {lane("a_1"), 90.0}, 1000.0);
  const Route route = graph_.toRoute(*path, 20.0, 90.0);
  // The change lies in the middle of the first 60 m: x = 20 + 30 = 50, blended from 37.5 to 62.5.
  for (const Eigen::Vector3d& point : route.path().points()) {
    const double t = std::clamp((point.x() - 37.5) / 25.0, 0.0, 1.0);
    EXPECT_NEAR(point.y(), 4.0 * t * t * (3.0 - 2.0 * t), 0.03) << point.x();
  }
  ASSERT_EQ(route.laneChanges().size(), 1u);
  EXPECT_NEAR(route.laneChanges()[0], 30.0, 1.5);
  for (double s = 0.5; s + 1.0 < route.length(); s += 1.0) {
    const double bend =
        core::angleDifference(route.path().headingAt(s + 1.0), route.path().headingAt(s));
    EXPECT_LT(std::abs(core::radiansToDegrees(bend)), 10.0);
  }
  EXPECT_EQ(route.path().points().back().head<2>(), Eigen::Vector2d(90.0, 4.0));
}

TEST(LaneGraphBlend, ReachesOverEdgeBordersBesideEachOther) {
  // Edges of 10 m, two lanes each, straight: a change on the second edge takes 25 m, not 10 m.
  test::NetworkText text;
  text.edge("a", {"0,0 10,0", "0,4 10,4"}).edge("b", {"10,0 20,0", "10,4 20,4"});
  text.edge("c", {"20,0 30,0", "20,4 30,4"});
  text.connection("a_0", "b_0").connection("a_1", "b_1");
  text.connection("b_0", "c_0").connection("b_1", "c_1");
  const RoadNetwork network = text.network();
  LanePath path;
  for (const char* id : {"a_0", "b_0", "b_1", "c_1"}) path.lanes.push_back(network.findLane(id));
  const Route route = LaneGraph(network).toRoute(path, 0.0, 10.0);
  for (const Eigen::Vector3d& point : route.path().points()) {
    const double t = std::clamp((point.x() - 2.5) / 25.0, 0.0, 1.0);
    EXPECT_NEAR(point.y(), 4.0 * t * t * (3.0 - 2.0 * t), 0.03) << point.x();
  }
  EXPECT_EQ(route.edges(), (std::vector<std::string>{"a", "b", "c"}));
}

TEST_F(LaneGraphTest, ExtendsStraightOnAndBeyondTheJunction) {
  const auto path = graph_.shortestPath({lane("a_0"), 20.0}, {lane("a_0"), 60.0}, 1000.0);
  const Route route = graph_.toRoute(*path, 20.0, 60.0);
  EXPECT_EQ(graph_.extended(route, 30.0).length(), route.length());
  const Route longer = graph_.extended(route, 70.0);
  EXPECT_NEAR(longer.length(), 70.0, 1e-6);
  EXPECT_EQ(longer.edges(), std::vector<std::string>{"a"});
  // 90 m would end 10 m inside the junction (x = 110): it goes on to 10 m beyond, x = 130.
  const Route beyond = graph_.extended(route, 90.0);
  EXPECT_NEAR(beyond.length(), 110.0, 1e-6);
  EXPECT_EQ(beyond.edges(), (std::vector<std::string>{"a", "b"}));
}

TEST_F(LaneGraphTest, ExtensionEndsWhereTheNetworkEnds) {
  const auto path = graph_.shortestPath({lane("c_0"), 0.0}, {lane("c_0"), 10.0}, 1000.0);
  const Route route = graph_.extended(graph_.toRoute(*path, 0.0, 10.0), 500.0);
  EXPECT_NEAR(route.length(), 60.0, 1e-6);
}

TEST(LaneGraphExtension, EndsAtTheVeryEndOfALaneThatEnds) {
  // Only the left lane of "a" goes on.
  test::NetworkText text;
  text.edge("a", {"0,0 100,0", "0,4 100,4"}, "k", "j")
      .edge(":j_0", {"100,4 120,4"})
      .edge("b", {"120,4 200,4"}, "j", "e")
      .connection("a_1", "b_0", ":j_0_0");
  const RoadNetwork network = text.network();
  const LaneGraph graph(network);
  const LanePath path{{network.findLane("a_0")}, 20.0};
  const Route at_end = graph.toRoute(path, 80.0, 100.0);
  EXPECT_EQ(graph.extended(at_end, 60.0).length(), at_end.length());
  EXPECT_GT(graph.extended(graph.toRoute(path, 60.0, 80.0), 60.0).length(), 50.0);
}

TEST(LaneGraphExtension, TakesTheStraightestFork) {
  test::NetworkText text;
  text.edge("a", {"0,0 50,0"}).edge("left", {"50,0 50,50"}).edge("slight", {"50,0 99,10"});
  text.edge("right", {"50,0 50,-50"});
  text.connection("a_0", "left_0").connection("a_0", "slight_0").connection("a_0", "right_0");
  const RoadNetwork network = text.network();
  const LaneGraph graph(network);
  LanePath path;
  path.lanes = {network.findLane("a_0")};
  const Route route = graph.extended(graph.toRoute(path, 0.0, 40.0), 80.0);
  EXPECT_EQ(route.edges(), (std::vector<std::string>{"a", "slight"}));
}

}  // namespace
}  // namespace cdiff::map
