// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Ways along edges, from a network that is written here: two lanes of 3 m (`a`) lead on through a
// junction (`b`, `d`, `e`, then back to `a`) or, from the left one, to the left (`c`, `f`, `g`).
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "map/lane_graph.h"
#include "simulation/crossing_world.h"
#include "simulation/edge_graph.h"
#include "support/network_text.h"

namespace cdiff {
namespace {

using simulation::DrivenRoute;
using simulation::EdgeGraph;
using simulation::LanePlace;
using simulation::LaneTarget;
using Names = std::vector<std::string>;

map::RoadNetwork twoWays() {
  const test::LaneText lane{3.0, 10.0, ""};
  return test::NetworkText()
      .edge("a", {"0,0 100,0", "0,3 100,3"}, "n", "j", lane)
      .edge(":on", {"100,0 110,0", "100,3 110,3"}, "", "", lane)
      .edge(":left", {"100,3 110,13"}, "", "", lane)
      .edge("b", {"110,0 200,0", "110,3 200,3"}, "j", "k", lane)
      .edge("d", {"200,0 250,0"}, "k", "l", lane)
      .edge("e", {"250,0 300,0"}, "l", "m", lane)
      .edge("c", {"110,13 110,100"}, "j", "o", lane)
      .edge("f", {"110,100 110,200"}, "o", "p", lane)
      .edge("g", {"110,200 110,300"}, "p", "q", lane)
      .edge("path", {"100,-3 200,-3"}, "j", "k", {3.0, 10.0, "pedestrian"})
      .connection("a_0", "path_0")
      .connection("a_0", "b_0", ":on_0")
      .connection("a_1", "b_1", ":on_1")
      .connection("a_1", "c_0", ":left_0", 'l')
      .connection("b_0", "d_0")
      .connection("d_0", "e_0")
      .connection("e_0", "a_0")
      .connection("c_0", "f_0")
      .connection("f_0", "g_0")
      .network();
}

class TwoWays : public testing::Test {
 protected:
  map::LaneIndex lane(const std::string& id) const { return network_.findLane(id); }
  std::vector<int> numbers(const Names& ids) const {
    std::vector<int> edges;
    for (const std::string& id : ids) edges.push_back(edges_.find(id));
    return edges;
  }
  Names extended(double length) const {
    std::vector<int> way = numbers({"a"});
    edges_.extend(way, length);
    return edges_.ids(way);
  }
  map::Route route(const std::string& from, const std::string& to) const {
    return test::routeOnFirstLanes(lanes_, from, to);
  }
  Names wayFrom(const DrivenRoute& way, const std::string& edge, double length) const {
    return edges_.ids(way.edgesFrom(edges_.find(edge), length));
  }
  /// Where the lane of the way from `from` is that a front bumper at (x, y) belongs to.
  std::optional<LaneTarget> target(double x, double y, double degrees, const Names& edges,
                                   const LanePlace& from) const {
    const DrivenRoute way(edges_, {});
    traffic::VehicleState state;
    state.heading = core::degreesToRadians(degrees);
    state.position =
        Eigen::Vector2d(x, y) - 0.5 * way.dimensions().length * geometry::direction(state.heading);
    return simulation::laneTarget(edges_, way.locate(state), state.heading, numbers(edges), from);
  }
  void expectTarget(const std::optional<LaneTarget>& found, const std::string& id,
                    double arc_length, std::optional<double> ahead) const {
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(network_.lane(found->place.lane).id, id);
    EXPECT_NEAR(found->place.arc_length, arc_length, 1e-9);
    ASSERT_EQ(found->ahead.has_value(), ahead.has_value());
    EXPECT_NEAR(found->ahead.value_or(0.0), ahead.value_or(0.0), 1e-9);
  }

  map::RoadNetwork network_ = twoWays();
  map::LaneGraph lanes_{network_};
  EdgeGraph edges_{network_};
};

// Cars may not go to the path; heading 0 at the end of `a`, a quarter turn at the start of `c`.
TEST_F(TwoWays, LinksSayLanesAndTurn) {
  const auto& links = edges_.links(edges_.find("a"));
  ASSERT_EQ(links.size(), 3U);
  const Names from = {"a_0", "a_1", "a_1"}, to = {"b_0", "b_1", "c_0"};
  for (std::size_t i = 0; i < links.size(); ++i) {
    EXPECT_EQ(network_.lane(links[i].from_lane).id, from[i]);
    EXPECT_EQ(network_.lane(links[i].to_lane).id, to[i]);
    EXPECT_EQ(edges_.id(links[i].to), to[i].substr(0, 1));
    EXPECT_NEAR(links[i].turn, i == 2 ? 0.5 * core::kPi : 0.0, 1e-9);
    EXPECT_TRUE(links[i].routable);
  }
  EXPECT_NEAR(edges_.length(edges_.find("b")), 90.0, 1e-9);
  EXPECT_EQ(edges_.lanes(edges_.find("a")).size(), 2U);
}

TEST_F(TwoWays, TheNextLaneIsThatOfTheRoute) {
  const auto next = [&](const std::string& from, const Names& route) {
    const map::LaneIndex found = edges_.nextLane(lane(from), numbers(route));
    return found == map::kNoLane ? std::string() : network_.lane(found).id;
  };
  EXPECT_EQ(next("a_0", {"a", "b"}), ":on_0");
  EXPECT_EQ(next("a_1", {"a", "b"}), ":on_1");
  EXPECT_EQ(next("a_1", {"a", "c"}), ":left_0");
  EXPECT_EQ(next(":left_0", {"a", "c"}), "c_0");
  EXPECT_EQ(next("a_0", {"a", "c"}), "") << "the left lane alone leads there";
  EXPECT_EQ(next("b_0", {"a", "b"}), "") << "the route ends";
  EXPECT_EQ(next("f_0", {"a", "b"}), "") << "not on the route";
}

TEST_F(TwoWays, LanesInsideAJunctionBelongToRoutesThroughIt) {
  const auto on = [&](const std::string& id, const Names& route) {
    return edges_.onRoute(lane(id), numbers(route));
  };
  EXPECT_TRUE(on(":on_0", {"a", "b"}));
  EXPECT_FALSE(on(":on_0", {"a", "c"}));
  EXPECT_FALSE(on(":on_0", {"a"}));
  EXPECT_TRUE(on(":left_0", {"e", "a", "c"}));
  EXPECT_TRUE(on("b_1", {"a", "b"}));
  EXPECT_FALSE(on("c_0", {"a", "b"}));
}

// Behind `a` come 90 m, 50 m and 50 m, then `a` again, which is not taken twice.
TEST_F(TwoWays, ExtendGoesStraightOnAndTakesNoEdgeTwice) {
  EXPECT_EQ(extended(10.0), (Names{"a", "b", "d"})) << "two at least";
  EXPECT_EQ(extended(139.0), (Names{"a", "b", "d"}));
  EXPECT_EQ(extended(141.0), (Names{"a", "b", "d", "e"}));
  EXPECT_EQ(extended(1000.0), (Names{"a", "b", "d", "e"}));
}

// Along the lanes from 95 m on `a`: 5 m to the junction, 15 m to `b`. Lanes are looked for up to
// 12 m ahead; `b` begins 11 m ahead of 99 m.
TEST_F(TwoWays, TheTargetIsOnTheLanesAhead) {
  const Names ab = {"a", "b"};
  expectTarget(target(97.0, 0.2, 0.0, ab, {lane("a_0"), 95.0}), "a_0", 97.0, 2.0);
  expectTarget(target(105.0, 0.2, 0.0, ab, {lane("a_0"), 95.0}), ":on_0", 5.0, 10.0);
  expectTarget(target(111.0, 0.2, 0.0, ab, {lane("a_0"), 99.0}), "b_0", 1.0, 12.0);
  expectTarget(target(111.0, 0.2, 0.0, ab, {lane("a_0"), 95.0}), "b_0", 1.0, std::nullopt);
  expectTarget(target(50.0, 0.5, 0.0, ab, {}), "a_0", 50.0, std::nullopt);
  expectTarget(target(50.0, 2.5, 0.0, ab, {}), "a_1", 50.0, std::nullopt);
}

// At y = 1.65 the other lane is nearer by 0.3 m (1.35 m against 1.65 m), at 1.8 by 0.6 m: it must
// be nearer by 0.4 m.
TEST_F(TwoWays, TheLanesAheadArePreferredToOthersThatAreLittleNearer) {
  const Names ab = {"a", "b"};
  expectTarget(target(50.0, 1.65, 0.0, ab, {lane("a_0"), 45.0}), "a_0", 50.0, 5.0);
  expectTarget(target(50.0, 1.8, 0.0, ab, {lane("a_0"), 45.0}), "a_1", 50.0, std::nullopt);
}

TEST_F(TwoWays, ATargetHasTheVehiclesDirectionAndLiesOnItsRoute) {
  const LanePlace from{lane("a_0"), 45.0};
  EXPECT_TRUE(target(50.0, 0.0, 80.0, {"a", "b"}, from).has_value());
  EXPECT_TRUE(target(50.0, 0.0, -80.0, {"a", "b"}, {}).has_value());
  EXPECT_FALSE(target(50.0, 0.0, 100.0, {"a", "b"}, from).has_value());
  EXPECT_FALSE(target(50.0, 0.0, -100.0, {"a", "b"}, {}).has_value());
  EXPECT_FALSE(target(50.0, 0.0, 0.0, {"c"}, {}).has_value());
}

// `length` behind the first edge, at least three edges in all.
TEST_F(TwoWays, EdgesFollowTheRouteAsFarAsWanted) {
  const map::Route on = route("a", "e");
  DrivenRoute way(edges_, {});
  EXPECT_TRUE(way.follow(&on, {50.0, 0.0}));
  EXPECT_FALSE(way.follow(&on, {52.0, 0.0}));
  EXPECT_EQ(wayFrom(way, "a", 50.0), (Names{"a", "b", "d"}));
  EXPECT_EQ(wayFrom(way, "a", 141.0), (Names{"a", "b", "d", "e"}));
  EXPECT_EQ(wayFrom(way, "b", 50.0), (Names{"b", "d", "e"})) << "SUMO is an edge ahead";
  EXPECT_TRUE(way.follow(nullptr, {52.0, 0.0}));
  EXPECT_EQ(wayFrom(way, "c", 50.0), (Names{"c", "f", "g"})) << "straight on without a route";
}

// The route turns left behind `a`; straight on would be `b`, `d`.
TEST_F(TwoWays, AnEdgeBehindTheRoutesPlaceIsItsOwnOneEdgeLong) {
  const map::Route left = route("a", "g");
  DrivenRoute way(edges_, {});
  way.follow(&left, {50.0, 3.0});
  EXPECT_EQ(wayFrom(way, "a", 50.0), (Names{"a", "c", "f"}));
  way.follow(&left, {110.0, 50.0});
  EXPECT_EQ(wayFrom(way, "a", 50.0), (Names{"a", "c", "f"})) << "SUMO is an edge behind";
  way.follow(&left, {110.0, 150.0});  // 100 m in one step: looked for on the whole route
  EXPECT_EQ(wayFrom(way, "a", 50.0), (Names{"a", "b", "d"})) << "two edges behind";
  EXPECT_EQ(wayFrom(way, "f", 50.0), (Names{"f", "g"})) << "where the network ends";
}

TEST_F(TwoWays, JustBeforeItsStartTheRouteIsAhead) {
  const map::Route later = route("c", "g");
  DrivenRoute way(edges_, {});
  way.follow(&later, {99.0, 3.0});
  EXPECT_EQ(wayFrom(way, "a", 50.0), (Names{"a", "c", "f"}));
}

// Lanes of 3 m: a car of 1.8 m reaches 2.35 m. At y = -1 it is on `a_0` alone.
TEST_F(TwoWays, ItStartsOnTheRouteBeforeTheNearestLane) {
  const map::Route left = route("c", "g");
  DrivenRoute way(edges_, {});
  const auto startAt = [&](double x, double y, double degrees) {
    traffic::VehicleState state;
    state.heading = core::degreesToRadians(degrees);
    state.position = Eigen::Vector2d(x, y) - 2.25 * geometry::direction(state.heading);
    const int edge = way.startEdge(way.locate(state));
    return edge == simulation::kNoEdge ? std::string() : edges_.id(edge);
  };
  way.follow(&left, {110.0, 20.0});
  EXPECT_EQ(startAt(50.0, -1.0, 0.0), "a");
  EXPECT_EQ(startAt(50.0, -1.0, 80.0), "a");
  EXPECT_EQ(startAt(50.0, -1.0, 100.0), "") << "against the lane";
  EXPECT_EQ(startAt(50.0, -2.4, 0.0), "") << "out of reach";
  EXPECT_EQ(startAt(110.0, 20.0, -90.0), "c") << "its route's, whatever the heading";
}

}  // namespace
}  // namespace cdiff
