// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/course.h"
#include "planners/pluto/reference_lines.h"

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

}  // namespace
}  // namespace cdiff::planners
