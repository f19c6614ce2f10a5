// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "map/lane_graph.h"
#include "planners/course.h"
#include "planners/pluto/reference_lines.h"
#include "support/network_text.h"

namespace cdiff::planners {
namespace {

using testing::straight;

/// "id_0" along y = 0 and "id_1" along y = 3.2, from x to x.
std::string twoLanes(const std::string& id, double from, double to) {
  std::string xml = "<edge id=\"" + id + "\">";
  for (const int lane : {0, 1}) {
    xml += "<lane id=\"" + id + "_" + std::to_string(lane) + "\" index=\"" + std::to_string(lane) +
           "\" speed=\"13.89\" shape=\"" +
           testing::pointText(straight(from, 3.2 * lane, to, 3.2 * lane)) + "\"/>";
  }
  return xml + "</edge>";
}

map::RoadNetwork networkOf(const std::string& content) {
  return map::RoadNetwork::fromText("<net>" + content + "</net>", "lines");
}

traffic::VehicleState at(double x, double y) {
  return testing::vehicleAt("own", x, y, 0.0, 5.0).state;
}

TEST(ReferenceLines, OnOneLaneThereIsTheRouteAlone) {
  const map::RoadNetwork network = testing::makeNetwork({{"road", straight(0.0, 0.0, 200.0, 0.0)}});
  const map::Route route = testing::routeAlong(network, {"road"});
  const auto lines = referenceLines(network, route, 10.0, at(10.0, 0.4), 4);
  ASSERT_EQ(lines.size(), 1U);
  ASSERT_EQ(lines[0].poses.size(), 121U);  // 120 m, both ends included
  for (std::size_t i = 0; i < 121; ++i) {
    EXPECT_NEAR(lines[0].poses[i].position.x(), 10.0 + static_cast<double>(i), 1e-9);
    EXPECT_NEAR(lines[0].poses[i].position.y(), 0.0, 1e-9);
    EXPECT_NEAR(lines[0].poses[i].heading, 0.0, 1e-9);
  }
}

TEST(ReferenceLines, TheNeighborLaneIsASecondLine) {
  const map::RoadNetwork network = networkOf(twoLanes("a", 0.0, 200.0));
  const map::Route route = testing::routeAlong(network, {"a"});
  const auto lines = referenceLines(network, route, 20.0, at(20.0, 0.0), 4);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NEAR(lines[1].poses.front().position.x(), 20.0, 1e-9) << "abreast of the vehicle";
  EXPECT_NEAR(lines[1].poses.front().position.y(), 3.2, 1e-9);
  EXPECT_EQ(referenceLines(network, route, 20.0, at(20.0, 0.0), 1).size(), 1U);
}

TEST(ReferenceLines, TheNeighborLaneGoesOnAlongTheRoute) {
  std::string links;
  for (const char* lane : {"0", "1"}) {
    links += std::string("<connection from=\"a\" to=\"b\" fromLane=\"") + lane + "\" toLane=\"" +
             lane + "\" dir=\"s\"/>";
  }
  const map::RoadNetwork network =
      networkOf(twoLanes("a", 0.0, 40.0) + twoLanes("b", 40.0, 240.0) + links);
  const map::Route route = testing::routeAlong(network, {"a", "b"});
  const auto lines = referenceLines(network, route, 0.0, at(0.0, 0.0), 4);
  ASSERT_EQ(lines.size(), 2U);
  ASSERT_EQ(lines[1].poses.size(), 121U);
  EXPECT_NEAR(lines[1].poses.back().position.x(), 120.0, 1e-9);
  EXPECT_NEAR(lines[1].poses.back().position.y(), 3.2, 1e-9);
}

// The left lane ends after 40 m, less than 0.8 x 120 m; the right one goes on.
TEST(ReferenceLines, ShortLinesGoWhereThereAreLongOnes) {
  const std::string next = "<edge id=\"b\"><lane id=\"b_0\" index=\"0\" speed=\"13.89\" shape=\"" +
                           testing::pointText(straight(40.0, 0.0, 240.0, 0.0)) + "\"/></edge>";
  const std::string link =
      "<connection from=\"a\" to=\"b\" fromLane=\"0\" toLane=\"0\" dir=\"s\"/>";
  const map::RoadNetwork network = networkOf(twoLanes("a", 0.0, 40.0) + next + link);
  const map::Route route = testing::routeAlong(network, {"a", "b"});
  const auto lines = referenceLines(network, route, 0.0, at(0.0, 0.0), 4);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].poses.size(), 121U);
}

/// A fork after 50 m: "b" goes on, "c" turns left.
map::RoadNetwork fork() {
  return testing::makeNetwork({{"a", straight(0.0, 0.0, 50.0, 0.0)},
                               {"b", straight(50.0, 0.0, 250.0, 0.0)},
                               {"c", straight(50.0, 0.0, 50.0, 200.0)}},
                              {{"a", "b", ""}, {"a", "c", ""}});
}

TEST(ReferenceLines, FollowTheEdgesOfTheRoute) {
  const map::RoadNetwork network = fork();
  const map::Route route = testing::routeAlong(network, {"a", "c"});
  const auto lines = referenceLines(network, route, 0.0, at(0.0, 0.0), 4);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NEAR(lines[0].poses.back().position.x(), 50.0, 1e-9);
  EXPECT_GT(lines[0].poses.back().position.y(), 60.0);
}

TEST(ReferenceLines, FromTheEndOfTheRouteGoStraightOn) {
  const map::RoadNetwork network = fork();
  const map::Route route = testing::routeAlong(network, {"a"});
  const auto lines = referenceLines(network, route, 30.0, at(30.0, 0.0), 4);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NEAR(lines[0].poses.back().position.x(), 150.0, 1e-9);
}

// A dead end at 50 m: 20 m are left, then 2 m straight on at the end itself and beyond it.
TEST(ReferenceLines, WhereTheNetworkEndsWhatIsLeftCounts) {
  const map::RoadNetwork network = testing::makeNetwork({{"road", straight(0.0, 0.0, 50.0, 0.0)}});
  const map::Route route = testing::routeAlong(network, {"road"});
  EXPECT_EQ(referenceLines(network, route, 30.0, at(30.0, 0.0), 4)[0].poses.size(), 21U);
  for (const double place : {50.0, 53.0}) {
    const auto lines = referenceLines(network, route, place, at(place, 0.0), 4);
    ASSERT_EQ(lines.size(), 1U) << place;
    EXPECT_GE(lines[0].length(), 2.0) << place;
    EXPECT_NEAR(lines[0].poses[1].position.x() - lines[0].poses[0].position.x(), 1.0, 1e-9);
  }
}

TEST(ReferenceLines, APlaceIsMeasuredFromTheNearestSegment) {
  ReferenceLine line;
  for (int i = 0; i <= 10; ++i) line.poses.push_back({{1.0 * i, 0.0}, 0.0});
  const LinePlace place = placeOn(line, {3.25, 2.0});
  EXPECT_NEAR(place.arc_length, 3.25, 1e-12);
  EXPECT_NEAR(place.offset, 2.0, 1e-12);
  EXPECT_NEAR(place.distance, 2.0, 1e-12);
  EXPECT_NEAR(placeOn(line, {13.0, 4.0}).arc_length, 10.0, 1e-12);
  EXPECT_NEAR(placeOn(line, {13.0, 4.0}).distance, 5.0, 1e-12);
}

/// Lanes of a road along x from 0 to 300 m, one for each y.
map::RoadNetwork lanesAt(const std::vector<double>& places) {
  std::vector<std::string> shapes;
  for (const double y : places)
    shapes.push_back("0," + std::to_string(y) + " 300," + std::to_string(y));
  return test::NetworkText().edge("road", shapes).network();
}

/// y of the beginnings of the lines from (20, y), heading [deg], with a route on the first lane.
std::vector<double> beginnings(const map::RoadNetwork& network, double y, double degrees,
                               std::size_t most = 4) {
  const map::LaneGraph graph(network);
  const map::Route route = graph.toRoute({{0}, 300.0}, 0.0, 300.0);
  traffic::VehicleState state = at(20.0, y);
  state.heading = core::degreesToRadians(degrees);
  std::vector<double> found;
  for (const ReferenceLine& line : referenceLines(network, route, 20.0, state, most))
    found.push_back(std::round(10.0 * line.poses.front().position.y()) / 10.0);
  return found;
}

// The route's line comes first, then the vehicle's own lane and those beside it, left before right.
TEST(ReferenceLines, AreTheRoutesTheOwnAndThoseBeside) {
  const map::RoadNetwork network = lanesAt({0.0, 3.2, 6.4, 9.6});
  using Places = std::vector<double>;
  EXPECT_EQ(beginnings(network, 0.0, 0.0), (Places{0.0, 3.2}));
  EXPECT_EQ(beginnings(network, 3.0, 0.0), (Places{0.0, 3.2, 6.4}));
  EXPECT_EQ(beginnings(network, 6.4, 0.0), (Places{0.0, 6.4, 9.6, 3.2}));
  EXPECT_EQ(beginnings(network, 9.6, 0.0), (Places{0.0, 9.6, 6.4}));
  EXPECT_EQ(beginnings(network, 6.4, 0.0, 3), (Places{0.0, 6.4, 9.6}));
}

// A lane is its own within 2 m and 60 degrees; else that of its route is.
TEST(ReferenceLines, TheOwnLaneIsNearAndRunsItsWay) {
  const map::RoadNetwork network = lanesAt({0.0, 3.2, 6.4});
  using Places = std::vector<double>;
  EXPECT_EQ(beginnings(network, 6.4, 55.0), (Places{0.0, 6.4, 3.2}));
  EXPECT_EQ(beginnings(network, 6.4, -55.0), (Places{0.0, 6.4, 3.2}));
  EXPECT_EQ(beginnings(network, 6.4, 65.0), (Places{0.0, 3.2}));
  EXPECT_EQ(beginnings(network, 6.4, -65.0), (Places{0.0, 3.2}));
  EXPECT_EQ(beginnings(network, 8.3, 0.0), (Places{0.0, 6.4, 3.2}));
  EXPECT_EQ(beginnings(network, 8.5, 0.0), (Places{0.0, 3.2}));
}

// A line that stays within 0.5 m of one that is kept is no other line.
TEST(ReferenceLines, LinesThatLieTogetherAreOne) {
  EXPECT_EQ(beginnings(lanesAt({0.0, 0.4}), 0.0, 0.0).size(), 1U);
  EXPECT_EQ(beginnings(lanesAt({0.0, 0.6}), 0.0, 0.0).size(), 2U);
}

// Both ways through the junction begin straight on; the one that is listed first ends turned by 45
// degrees, the other goes on.
TEST(ReferenceLines, StraightOnIsTheWayWhoseEndTurnsLeast) {
  const map::RoadNetwork network = test::NetworkText()
                                       .edge("a", {"0,0 50,0"})
                                       .edge(":turn", {"50,0 55,0 60,5"})
                                       .edge(":on", {"50,0 60,0"})
                                       .edge("b", {"60,5 160,105"})
                                       .edge("c", {"60,0 260,0"})
                                       .connection("a_0", "b_0", ":turn_0")
                                       .connection("a_0", "c_0", ":on_0")
                                       .network();
  const map::LaneGraph graph(network);
  const map::Route route = graph.toRoute({{network.findLane("a_0")}, 50.0}, 0.0, 50.0);
  const auto lines = referenceLines(network, route, 10.0, at(10.0, 0.0), 4);
  ASSERT_EQ(lines.size(), 1U);
  ASSERT_EQ(lines[0].poses.size(), 121U);
  for (std::size_t i = 0; i < 121; ++i) {
    EXPECT_NEAR(lines[0].poses[i].position.x(), 10.0 + static_cast<double>(i), 1e-9);
    EXPECT_NEAR(lines[0].poses[i].position.y(), 0.0, 1e-9);
  }
}

// 5 m along x, then 5 m along y.
TEST(ReferenceLines, APlaceHasTheSideAndHeadingOfItsPart) {
  ReferenceLine line;
  for (int i = 0; i <= 5; ++i) line.poses.push_back({{1.0 * i, 0.0}, 0.0});
  for (int i = 1; i <= 5; ++i) line.poses.push_back({{5.0, 1.0 * i}, 0.5 * core::kPi});
  const LinePlace right = placeOn(line, {2.5, -1.5});
  EXPECT_NEAR(right.offset, -1.5, 1e-12);
  EXPECT_NEAR(right.heading, 0.0, 1e-12);
  const LinePlace upper = placeOn(line, {4.25, 3.5});
  EXPECT_NEAR(upper.arc_length, 8.5, 1e-12);
  EXPECT_NEAR(upper.offset, 0.75, 1e-12);
  EXPECT_NEAR(upper.heading, 0.5 * core::kPi, 1e-12);
  EXPECT_NEAR(placeOn(line, {-3.0, 4.0}).distance, 5.0, 1e-12);
  EXPECT_NEAR(placeOn(line, {-3.0, 4.0}).arc_length, 0.0, 1e-12);
}

}  // namespace
}  // namespace cdiff::planners
