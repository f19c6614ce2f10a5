// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Edges of the crossing, the way of a driven vehicle along them, and SUMO's convention of places.
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "simulation/crossing_world.h"
#include "simulation/edge_graph.h"
#include "simulation/sumo_conventions.h"

namespace cdiff {
namespace {

using simulation::DrivenRoute;
using simulation::EdgeGraph;

TEST(SumoConversion, AnglesAreClockwiseFromNorth) {
  EXPECT_NEAR(simulation::headingFromAngle(0.0), 0.5 * core::kPi, 1e-12);  // north
  EXPECT_NEAR(simulation::headingFromAngle(90.0), 0.0, 1e-12);             // east
  EXPECT_NEAR(simulation::headingFromAngle(180.0), -0.5 * core::kPi, 1e-12);
  EXPECT_NEAR(std::abs(simulation::headingFromAngle(270.0)), core::kPi, 1e-12);
  for (double angle = 0.0; angle < 360.0; angle += 7.5) {
    EXPECT_NEAR(simulation::angleFromHeading(simulation::headingFromAngle(angle)), angle, 1e-9);
  }
}

TEST(SumoConversion, TheFrontBumperIsHalfALengthAhead) {
  // Heading north at (3, 4), 5 m long: front at (3, 6.5).
  const Eigen::Vector2d front = simulation::frontOf({{3.0, 4.0}, 0.5 * core::kPi}, 5.0);
  EXPECT_NEAR(front.x(), 3.0, 1e-12);
  EXPECT_NEAR(front.y(), 6.5, 1e-12);
  EXPECT_NEAR(
      (simulation::centerBehind(front, 0.5 * core::kPi, 5.0) - Eigen::Vector2d(3.0, 4.0)).norm(),
      0.0, 1e-12);
}

class Crossing : public testing::Test {
 protected:
  Crossing()
      : made_(test::makeCrossing(folder_, true)),
        lanes_(made_.network),
        edges_(made_.network),
        route_(test::routeOnFirstLanes(lanes_, "west", "north")) {}
  std::vector<std::string> wayFrom(const std::string& edge, const map::Route* route, double length,
                                   const Eigen::Vector2d& front) const {
    DrivenRoute way(edges_, {});
    way.follow(route, front);
    return edges_.ids(way.edgesFrom(edges_.find(edge), length));
  }

  test::TemporaryFolder folder_;
  test::SumoNetwork made_;
  map::LaneGraph lanes_;
  EdgeGraph edges_;
  map::Route route_;
};

using Names = std::vector<std::string>;

TEST_F(Crossing, LinksLeadThroughTheJunction) {
  EXPECT_TRUE(edges_.connected(edges_.find("west"), edges_.find("east")));
  EXPECT_TRUE(edges_.connected(edges_.find("west"), edges_.find("north")));
  EXPECT_FALSE(edges_.connected(edges_.find("west"),
                                edges_.find("south")));  // its direction is toward the crossing
  EXPECT_EQ(edges_.find("nowhere"), simulation::kNoEdge);
  const map::Lane& lane = made_.network.lane(made_.network.findLane("west_0"));
  for (const map::LaneLink& link : lane.next) {
    EXPECT_EQ(edges_.edgeOf(link.to), edges_.find("west"));
    EXPECT_TRUE(edges_.connected(edges_.find("west"), edges_.edgeAfter(link.to)));
  }
}

TEST_F(Crossing, ExtendsStraightOn) {
  std::vector<int> way = {edges_.find("west")};
  edges_.extend(way, 300.0);
  EXPECT_EQ(edges_.ids(way), (Names{"west", "east", "far"}));
}

TEST_F(Crossing, ItsEdgesFollowTheRoute) {
  // The route turns left; the network ends 200 m behind the crossing, where only a turn back is
  // left.
  const Names way = wayFrom("west", &route_, 150.0, {-100.0, -1.6});
  ASSERT_GE(way.size(), 2U);
  EXPECT_EQ(way[0], "west");
  EXPECT_EQ(way[1], "north");
}

TEST_F(Crossing, OffTheRouteItGoesStraightOn) {
  EXPECT_EQ(wayFrom("south", &route_, 100.0, {1.6, -100.0}).at(1), "north");
  EXPECT_EQ(wayFrom("west", nullptr, 250.0, {-100.0, -1.6}), (Names{"west", "east", "far"}));
}

TEST_F(Crossing, ABridgeIsNotWithinReach) {
  DrivenRoute way(edges_, {});
  traffic::VehicleState state;
  state.position = {-30.0 - 2.25, -1.6};  // front bumper under the bridge at x = -30 m
  for (const map::LaneMatch& match : way.locate(state).lanes) {
    EXPECT_NE(made_.network.lane(match.lane).edge_id.substr(0, 6), "bridge");
  }
  EXPECT_EQ(way.startEdge(way.locate(state)), edges_.find("west"));
  state.elevation = 8.0;
  state.heading = 0.5 * core::kPi;
  state.position = {-28.4, 0.0};  // northward lane of the bridge
  EXPECT_EQ(way.startEdge(way.locate(state)), edges_.find("bridge"));
}

TEST_F(Crossing, ReachEndsHalfALaneAndHalfAVehicleBesideTheLane) {
  DrivenRoute way(edges_, {});
  const std::vector<int> given = {edges_.find("west"), edges_.find("east")};
  traffic::VehicleState state;
  state.position = {-100.0, -1.6 - 2.4};  // (3.2 + 1.8) / 2 = 2.5 m, less 0.05 m
  EXPECT_TRUE(way.onRoute(way.locate(state), given, 1.0));
  state.position.y() = -1.6 - 2.5;
  EXPECT_FALSE(way.onRoute(way.locate(state), given, 1.0));
}

}  // namespace
}  // namespace cdiff
