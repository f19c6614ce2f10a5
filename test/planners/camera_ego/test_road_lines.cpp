// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace cdiff::planners
