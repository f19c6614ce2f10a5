// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "e2e_cdiff/core/angle.h"
#include "planners/camera_ego/road_lines.h"
#include "support/network_text.h"

namespace cdiff::planners {
namespace {

int countOf(const std::vector<BevLine>& lines, MapKind kind) {
  return static_cast<int>(std::count_if(lines.begin(), lines.end(),
                                        [&](const BevLine& line) { return line.kind == kind; }));
}

// Two lanes of 4 m in one direction, at y = 0 and y = 4: edges at -2 and 6, a divider at 2.
TEST(RoadLines, AreThoseOfATwoLaneRoad) {
  const map::RoadNetwork network = map::RoadNetwork::fromText(
      test::NetworkText().edge("road", {"0,0 300,0", "0,4 300,4"}).text(), "test");
  const map::DrivableArea area(network);
  const RoadLines lines(network, area);
  const BevGrid bev;
  const std::vector<BevLine> seen = lines.around({{{100.0, 0.0}, 0.0}, 0.0}, bev, 16);
  ASSERT_EQ(countOf(seen, MapKind::kCenter), 2);
  ASSERT_EQ(countOf(seen, MapKind::kDivider), 1);
  ASSERT_EQ(countOf(seen, MapKind::kEdge), 2);
  EXPECT_EQ(seen.front().kind, MapKind::kCenter) << "the ego's own lane is nearest";
  for (const BevLine& line : seen) {
    EXPECT_NEAR(std::abs(line.points.front().x() - line.points.back().x()), 60.0, 1e-6);
    if (line.kind == MapKind::kDivider) {
      EXPECT_NEAR(line.points[4].y(), 2.0, 1e-6);
    } else if (line.kind == MapKind::kCenter) {
      EXPECT_GT(line.points.back().x(), line.points.front().x()) << "in the lane's direction";
    } else {
      EXPECT_NEAR(std::min(std::abs(line.points[4].y() + 2.0), std::abs(line.points[4].y() - 6.0)),
                  0.0, 1e-3);
    }
  }
  EXPECT_EQ(lines.around({{{100.0, 0.0}, 0.0}, 0.0}, bev, 2).size(), 2U);
}

// Above the road of two lanes a bridge of one, 4 m wide: no line of the one is seen from the other.
TEST(RoadLines, AreThoseOfTheEgosLevel) {
  const map::RoadNetwork network =
      map::RoadNetwork::fromText(test::NetworkText()
                                     .edge("road", {"0,0,0 300,0,0", "0,4,0 300,4,0"})
                                     .edge("bridge", {"0,0,9 300,0,9"})
                                     .text(),
                                 "test");
  const map::DrivableArea area(network);
  const RoadLines lines(network, area);
  const auto below = lines.around({{{100.0, 0.0}, 0.0}, 0.0}, BevGrid{}, 16);
  EXPECT_EQ(countOf(below, MapKind::kCenter), 2);
  EXPECT_EQ(countOf(below, MapKind::kEdge), 2);
  const auto above = lines.around({{{100.0, 0.0}, 0.0}, 9.0}, BevGrid{}, 16);
  EXPECT_EQ(countOf(above, MapKind::kCenter), 1);
  EXPECT_EQ(countOf(above, MapKind::kDivider), 0);
  ASSERT_EQ(countOf(above, MapKind::kEdge), 2);
  for (const BevLine& line : above) {
    if (line.kind != MapKind::kEdge) continue;
    EXPECT_NEAR(std::abs(line.points[4].y()), 2.0, 1e-3);
  }
}

// The road ends 10 m ahead: 22 m of it lie within the view.
TEST(RoadLines, AreCutAtTheView) {
  const map::RoadNetwork network =
      map::RoadNetwork::fromText(test::NetworkText().edge("road", {"0,0 110,0"}).text(), "test");
  const map::DrivableArea area(network);
  const auto seen = RoadLines(network, area).around({{{100.0, 0.0}, 0.0}, 0.0}, BevGrid{}, 16);
  for (const BevLine& line : seen) {
    if (line.kind != MapKind::kCenter) continue;
    EXPECT_NEAR(line.points.front().x(), -12.0, 1e-6);
    EXPECT_NEAR(line.points.back().x(), 10.0, 1e-6);
    EXPECT_NEAR(line.points[1].x(), -12.0 + 22.0 / 9.0, 1e-6);
    return;
  }
  FAIL() << "no centerline";
}

/// Roads for an ego at (100, 0) that looks along x: its view reaches from -12 to 48 m, 15 m to
/// either side.
class RoadLinesOf {
 public:
  explicit RoadLinesOf(const test::NetworkText& text) : network_(text.network()) {}

  std::vector<BevLine> seenFrom(const BevPose& from) const {
    return lines_.around(from, BevGrid{}, 99);
  }
  std::vector<BevLine> centers(const BevPose& from = {{{100.0, 0.0}, 0.0}, 0.0}) const {
    std::vector<BevLine> seen = seenFrom(from);
    seen.erase(std::remove_if(seen.begin(), seen.end(),
                              [](const BevLine& line) { return line.kind != MapKind::kCenter; }),
               seen.end());
    return seen;
  }

 private:
  map::RoadNetwork network_;
  map::DrivableArea area_{network_};
  RoadLines lines_{network_, area_};
};

RoadLinesOf lane(const std::string& shape) {
  return RoadLinesOf(test::NetworkText().edge("road", {shape}));
}

void expectPoint(const BevLine& line, std::size_t index, double x, double y) {
  EXPECT_NEAR(line.points[index].x(), x, 1e-9) << index;
  EXPECT_NEAR(line.points[index].y(), y, 1e-9) << index;
}

// 10 m ahead and then 8 m to the left: 18 m, 9 parts of 2 m; the corner is the sixth point.
TEST(RoadLines, HaveTheirPointsEvenlyAroundACorner) {
  const auto seen = lane("110,0 120,0 120,8").centers();
  ASSERT_EQ(seen.size(), 1U);
  for (std::size_t i = 0; i < 6; ++i) expectPoint(seen[0], i, 10.0 + 2.0 * i, 0.0);
  for (std::size_t i = 6; i < kLinePoints; ++i) expectPoint(seen[0], i, 20.0, 2.0 * (i - 5.0));
}

// Out of the view at 48 m and back 10 m to the left: two pieces of 38 m, the nearer one first.
TEST(RoadLines, ThatComeBackIntoTheViewAreTwoPieces) {
  const auto seen = lane("110,0 160,0 160,10 110,10").centers();
  ASSERT_EQ(seen.size(), 2U);
  for (std::size_t i = 0; i < kLinePoints; ++i) {
    expectPoint(seen[0], i, 10.0 + 38.0 / 9.0 * i, 0.0);
    expectPoint(seen[1], i, 48.0 - 38.0 / 9.0 * i, 10.0);
  }
}

// From one side of the view to the other: y from -15 to 15 m, 30 m in nine parts.
TEST(RoadLines, AcrossAreCutAtBothSides) {
  const auto seen = lane("120,-100 120,100").centers();
  ASSERT_EQ(seen.size(), 1U);
  for (std::size_t i = 0; i < kLinePoints; ++i)
    expectPoint(seen[0], i, 20.0, -15.0 + 30.0 / 9.0 * i);
  EXPECT_TRUE(lane("0,15.5 300,15.5").centers().empty());
  EXPECT_TRUE(lane("0,-15.5 300,-15.5").centers().empty());
  EXPECT_TRUE(lane("148.5,-100 148.5,100").centers().empty());
  EXPECT_EQ(lane("0,14.5 300,14.5").centers().size(), 1U);
}

TEST(RoadLines, OfLessThanThreeMetersAreLeftOut) {
  EXPECT_TRUE(lane("110,0 112.9,0").centers().empty());
  EXPECT_EQ(lane("110,0 113.1,0").centers().size(), 1U);
}

TEST(RoadLines, BehindTheEgoAreLeftOut) {
  EXPECT_TRUE(lane("80,0 99.9,0").centers().empty());
  EXPECT_EQ(lane("80,0 100.1,0").centers().size(), 1U);
}

// From (5, 0): 6 m to y = -6, 8 m to the lane that begins at x = 13, 9 m to y = 9.
TEST(RoadLines, AreOrderedFromFiveMetersAhead) {
  const auto seen = RoadLinesOf(test::NetworkText()
                                    .edge("ahead", {"113,0 140,0"})
                                    .edge("left", {"0,9 300,9"})
                                    .edge("right", {"0,-6 300,-6"}))
                        .centers();
  ASSERT_EQ(seen.size(), 3U);
  expectPoint(seen[0], 0, -12.0, -6.0);
  expectPoint(seen[1], 0, 13.0, 0.0);
  expectPoint(seen[2], 0, -12.0, 9.0);
}

// Lanes of 4 m side by side, one each way: one divider at y = 2, whichever way the road runs.
TEST(RoadLines, TwoDirectionsShareOneDivider) {
  for (const double heading : {0.0, 0.5, 1.4, 1.8, 3.0}) {
    const Eigen::Rotation2Dd turn(heading);
    const auto place = [&](double x, double y) {
      const Eigen::Vector2d point = turn * Eigen::Vector2d(x, y);
      return std::to_string(point.x()) + "," + std::to_string(point.y());
    };
    const RoadLinesOf road(
        test::NetworkText()
            .edge("there", {place(0.0, 0.0) + " " + place(300.0, 0.0)})
            .edge("back", {place(300.0, 4.0) + " " + place(0.0, 4.0)}, "b", "a"));
    const auto seen = road.seenFrom({{turn * Eigen::Vector2d(100.0, 0.0), heading}, 0.0});
    ASSERT_EQ(countOf(seen, MapKind::kDivider), 1) << heading;
    for (const BevLine& line : seen) {
      if (line.kind != MapKind::kDivider) continue;
      for (const Eigen::Vector2d& point : line.points) EXPECT_NEAR(point.y(), 2.0, 1e-4);
    }
  }
}

/// Into a junction from the west and the south; from the west one may go on or turn left.
RoadLinesOf junction() {
  return RoadLinesOf(test::NetworkText()
                         .edge("west", {"0,0 100,0"})
                         .edge("east", {"120,0 300,0"})
                         .edge("south", {"110,-100 110,-10"})
                         .edge("north", {"110,10 110,100"})
                         .edge(":on", {"100,0 120,0"})
                         .edge(":left", {"100,0 110,10"})
                         .edge(":up", {"110,-10 110,10"})
                         .connection("west_0", "east_0", ":on_0")
                         .connection("west_0", "north_0", ":left_0", 'l')
                         .connection("south_0", "north_0", ":up_0"));
}

bool passes(const std::vector<BevLine>& lines, const BevPose& from, const Eigen::Vector2d& place) {
  const Eigen::Vector2d wanted = from.pose.toBody(place);
  return std::any_of(lines.begin(), lines.end(), [&](const BevLine& line) {
    return std::any_of(line.points.begin(), line.points.end(),
                       [&](const auto& point) { return (point - wanted).norm() < 1.2; });
  });
}

// (115, 0) lies on the way on alone, (106, 6) on the turn, (110, -4) on the way up.
TEST(RoadLines, InAJunctionAreThoseThatTheEgosLanesLeadTo) {
  const RoadLinesOf roads = junction();
  const BevPose from_west{{{90.0, 0.0}, 0.0}, 0.0};
  const auto west = roads.centers(from_west);
  EXPECT_EQ(west.size(), 6U) << "the four roads and two ways";
  EXPECT_TRUE(passes(west, from_west, {115.0, 0.0}));
  EXPECT_TRUE(passes(west, from_west, {106.0, 6.0}));
  EXPECT_FALSE(passes(west, from_west, {110.0, -4.0}));
  const BevPose from_south{{{110.0, -12.0}, 0.5 * core::kPi}, 0.0};
  const auto south = roads.centers(from_south);
  EXPECT_EQ(south.size(), 5U) << "the four roads and one way";
  EXPECT_FALSE(passes(south, from_south, {115.0, 0.0}));
  EXPECT_FALSE(passes(south, from_south, {106.0, 6.0}));
  EXPECT_TRUE(passes(south, from_south, {110.0, -4.0}));
}

// A lane is the ego's within 3 m and 60 degrees.
TEST(RoadLines, InAJunctionDependOnTheEgosPlaceAndHeading) {
  const RoadLinesOf roads = junction();
  const auto ways = [&](double y, double degrees) {
    const BevPose from{{{95.0, y}, core::degreesToRadians(degrees)}, 0.0};
    return passes(roads.centers(from), from, {107.0, 0.0});
  };
  EXPECT_TRUE(ways(0.0, 0.0));
  EXPECT_TRUE(ways(0.0, 45.0));
  EXPECT_FALSE(ways(0.0, 70.0));
  EXPECT_TRUE(ways(0.0, -45.0));
  EXPECT_FALSE(ways(0.0, -70.0));
  EXPECT_TRUE(ways(-2.0, 0.0));
  EXPECT_FALSE(ways(-4.5, 0.0));
}

}  // namespace
}  // namespace cdiff::planners
