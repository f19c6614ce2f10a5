// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "page/pictures/map_canvas.h"

namespace cdiff::page {
namespace {

const Region kSquare{{0.0, 0.0}, {10.0, 10.0}};

double areaOf(const Points& ring) {
  double doubled = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& next = ring[(i + 1) % ring.size()];
    doubled += ring[i].x() * next.y() - ring[i].y() * next.x();
  }
  return 0.5 * doubled;
}

TEST(PictureGeometry, ThinsALineToItsTolerance) {
  // The bend at (5, 1) lies 1 m off the chord, (2, 0.45) only 0.05 m off the line to it.
  const Points line = {{0, 0}, {2, 0.45}, {5, 1}, {10, 0}};
  const Points thin = simplified(line, 0.1);
  ASSERT_EQ(thin.size(), 3u);
  EXPECT_EQ(thin[1], line[2]);
  EXPECT_EQ(simplified(line, 2.0).size(), 2u);
}

TEST(PictureGeometry, KeepsTheFarPointOfAClosedLine) {
  const Points line = {{0, 0}, {10, 0}, {0, 0}};
  EXPECT_EQ(simplified(line, 0.1).size(), 3u);
}

TEST(PictureGeometry, ClipsARingToTheRegion) {
  // 20 m x 4 m, half of it inside: 10 m x 4 m.
  const Points ring = {{-10, 3}, {10, 3}, {10, 7}, {-10, 7}};
  EXPECT_DOUBLE_EQ(areaOf(clippedRing(ring, kSquare)), 40.0);
  EXPECT_TRUE(clippedRing({{20, 20}, {30, 20}, {30, 30}}, kSquare).empty());
  const Points around = {{-5, -5}, {15, -5}, {15, 15}, {-5, 15}};
  EXPECT_DOUBLE_EQ(areaOf(clippedRing(around, kSquare)), 100.0);
}

TEST(PictureGeometry, CutsALineIntoStretches) {
  // In from the left, out to the right, back far above, in again from the right.
  const Points line = {{-20, 5}, {-10, 5}, {5, 5}, {20, 5}, {20, 50}, {40, 50}, {40, 5}, {8, 5}};
  const auto stretches = stretchesIn(line, kSquare);
  ASSERT_EQ(stretches.size(), 2u);
  EXPECT_EQ(stretches[0], Points({{-10, 5}, {5, 5}, {20, 5}}));
  EXPECT_EQ(stretches[1], Points({{40, 5}, {8, 5}}));
}

TEST(PictureGeometry, KeepsASegmentThatCrossesWithBothEndsOutside) {
  const auto stretches = stretchesIn({{-100, 5}, {100, 5}}, kSquare);
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].size(), 2u);
}

}  // namespace
}  // namespace cdiff::page
