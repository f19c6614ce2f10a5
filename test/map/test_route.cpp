// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/map/route.h"
#include "support/network_text.h"

namespace cdiff::map {
namespace {

using Points = std::vector<Eigen::Vector3d>;
using Names = std::vector<std::string>;

/// Eastwards: a (50 m, two lanes), a junction of 10 m, a tiny edge "t" of 0.2 m, a stub, b (40 m);
/// a bridge over it at x = 25.
RoadNetwork street() {
  std::string text = test::NetworkText()
                         .edge("a", {"0,0 50,0", "0,4 50,4"}, "x", "j")
                         .edge(":j_0", {"50,0 60,0"})
                         .edge("t", {"60,0 60.2,0"}, "j", "k")
                         .edge(":k_0", {"60.2,0 60.2,0"})
                         .edge("b", {"60.2,0 100,0"}, "k", "y")
                         .edge("bridge", {"25,-50,8 25,50,8"}, "m", "n")
                         .connection("a_0", "t_0", ":j_0_0")
                         .connection("t_0", "b_0", ":k_0_0")
                         .text();
  const std::string first = "from=\"a\" to=\"t\" fromLane=\"0\" toLane=\"0\"";
  text.replace(text.find(first), first.size(), first + " tl=\"light\" linkIndex=\"3\"");
  return RoadNetwork::fromText(text, "street");
}

Points lineFrom(double begin, double end, double step, double y, double z = 0.0) {
  Points points;
  for (double x = begin; x <= end; x += step) points.emplace_back(x, y, z);
  return points;
}

Names laneNames(const RoadNetwork& network, const Route& route) {
  Names names;
  for (const LaneIndex lane : route.lanes()) names.push_back(network.lane(lane).id);
  return names;
}

std::string matchError(const RoadNetwork& network, const Points& points) {
  try {
    matchRoute(network, points);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Route, KnowsEdgesJunctionsAndSignals) {
  const RoadNetwork network = street();
  const Route route = matchRoute(network, lineFrom(30.5, 80.5, 1.0, 0.0));
  // The tiny edge holds no point (60.5 lies behind it) and is still driven.
  EXPECT_EQ(route.edges(), (Names{"a", "t", "b"}));
  EXPECT_EQ(route.edgeStarts(), (std::vector<double>{0.0, 30.0, 30.0}));
  ASSERT_EQ(route.signals().size(), 1u);
  EXPECT_EQ(route.signals()[0].id, "light");
  EXPECT_EQ(route.signals()[0].link, 3);
  EXPECT_NEAR(route.signals()[0].arc_length, 50.0 - 30.5, 1e-9);
  ASSERT_EQ(route.junctionStretches().size(), 1u);
  EXPECT_NEAR(route.junctionStretches()[0].first, 20.0, 1e-9);   // x = 50.5
  EXPECT_NEAR(route.junctionStretches()[0].second, 30.0, 1e-9);  // x = 60.5
  EXPECT_FALSE(route.inJunctionAt(19.5));
  EXPECT_TRUE(route.inJunctionAt(25.0));
  EXPECT_EQ(network.lane(route.laneAt(-5.0)).id, "a_0");
  EXPECT_EQ(network.lane(route.laneAt(500.0)).id, "b_0");
  EXPECT_DOUBLE_EQ(route.speedLimitAt(3.0), 10.0);
}

TEST(Route, KnowsStopSignsByTheRightOfWayOfItsLinks) {
  const auto streetWith = [](const std::string& state) {
    test::NetworkText text;
    text.edge("a", {"0,0 50,0"}, "x", "j").edge(":j_0", {"50,0 60,0"});
    text.edge("b", {"60,0 100,0"}, "j", "y");
    text.connection("a_0", "b_0", ":j_0_0", 's', "state=\"" + state + "\"");
    return RoadNetwork::fromText(text.text(), "street");
  };
  for (const std::string stop : {"s", "w"}) {
    const Route route = matchRoute(streetWith(stop), lineFrom(30.5, 80.5, 1.0, 0.0));
    ASSERT_EQ(route.stopSigns().size(), 1u) << stop;
    EXPECT_NEAR(route.stopSigns()[0], 50.0 - 30.5, 1e-9);
    EXPECT_TRUE(route.signals().empty());
  }
  for (const std::string other : {"M", "m", "=", "o", "-"}) {
    const Route route = matchRoute(streetWith(other), lineFrom(30.5, 80.5, 1.0, 0.0));
    EXPECT_TRUE(route.stopSigns().empty()) << other;
  }
}

TEST(Route, MergesRepeatedPointsWithTheirLanes) {
  const RoadNetwork network = street();
  const LaneIndex a = network.findLane("a_0");
  const LaneIndex beside = network.findLane("a_1");
  const Route route(network, {{0, 0, 0}, {0, 0, 0}, {5, 0, 0}, {10, 4, 0}}, {a, a, a, beside});
  EXPECT_EQ(route.lanes(), (std::vector<LaneIndex>{a, a, beside}));
  ASSERT_EQ(route.laneChanges().size(), 1u);
  EXPECT_NEAR(route.laneChanges()[0], 5.0 + std::hypot(5.0, 4.0), 1e-12);
  EXPECT_THROW(Route(network, {{0, 0, 0}, {5, 0, 0}}, {a}), core::InputError);
}

TEST(MatchRoute, AcceptsPointsFarApartAndNoisy) {
  const RoadNetwork network = street();
  const Route route = matchRoute(
      network, {{10, 0.9, 0}, {16, -1.2, 0}, {23, 0.4, 0}, {48, 0, 0}, {66, 0.3, 0}, {90, 0, 0}});
  EXPECT_EQ(laneNames(network, route), (Names{"a_0", "a_0", "a_0", "a_0", "b_0", "b_0"}));
  EXPECT_EQ(route.edges(), (Names{"a", "t", "b"}));
}

TEST(MatchRoute, FollowsALaneChangeBetweenTheCenterLines) {
  const RoadNetwork network = street();
  Points points;
  for (int x = 0; x <= 40; ++x) points.emplace_back(x, std::clamp(0.2 * (x - 10), 0.0, 4.0), 0.0);
  const Route route = matchRoute(network, points);
  ASSERT_EQ(route.laneChanges().size(), 1u);
  EXPECT_NEAR(route.laneChanges()[0], 20.5, 2.0);  // halfway, y = 2, at x = 20
  EXPECT_EQ(network.lane(route.lanes().front()).id, "a_0");
  EXPECT_EQ(network.lane(route.lanes().back()).id, "a_1");
}

TEST(MatchRoute, ChoosesTheLevelByElevation) {
  const RoadNetwork network = street();
  const Points up = {{25, -20, 7.5}, {25, 0, 7.5}, {25, 20, 7.5}};
  EXPECT_EQ(laneNames(network, matchRoute(network, up)), Names(3, "bridge_0"));
  // All z = 0 in a network with elevation means that the points have none: heading and connection
  // decide.
  const Points unknown = {{25, -20, 0}, {25, 0, 0}, {25, 20, 0}};
  EXPECT_EQ(laneNames(network, matchRoute(network, unknown)), Names(3, "bridge_0"));
  EXPECT_EQ(matchRoute(network, lineFrom(20, 30, 1, 0.0)).edges(), Names{"a"});
}

TEST(MatchRoute, NamesThePointThatIsOffEveryLane) {
  const RoadNetwork network = street();
  // Lanes here are 4 m wide: 2 m are accepted. y = -2.31 is 2.31 m off a_0.
  const std::string message = matchError(network, {{1, 0, 0}, {2, 0, 0}, {3, -2.31, 0}, {4, 0, 0}});
  EXPECT_NE(message.find("point 2 (3.00, -2.31) is 2.31 m off every lane; the nearest is 'a_0'"),
            std::string::npos)
      << message;
  EXPECT_EQ(matchError(network, {{1, 1.9, 0}, {2, 1.9, 0}}), "no error");
}

TEST(MatchRoute, NamesAGapBetweenLanes) {
  const RoadNetwork network = street();
  const std::string message =
      matchError(network, {{22, 0, 0}, {24, 0, 0}, {25, -4, 8}, {25, -8, 8}});
  EXPECT_NE(
      message.find("no lane-connected route from point 1 (24.00, 0.00) to point 2 (25.00, -4.00)"),
      std::string::npos)
      << message;
  Points backwards = lineFrom(0, 20, 2, 0.0);
  std::reverse(backwards.begin(), backwards.end());
  EXPECT_NE(matchError(network, backwards).find("no lane-connected route from point 0"),
            std::string::npos);
  EXPECT_NE(matchError(network, {{1, 0, 0}, {1, 0, 0}}).find("two distinct points"),
            std::string::npos);
}

}  // namespace
}  // namespace cdiff::map
