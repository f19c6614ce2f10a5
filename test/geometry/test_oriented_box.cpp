// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::geometry {
namespace {

// Boxes 4 x 2 along x: centers 5 apart leave a gap of 5 - 4 = 1.
TEST(OrientedBox, GapBehindEachOther) {
  const OrientedBox first{{0, 0}, 0.0, 4.0, 2.0};
  const OrientedBox second{{5, 0}, 0.0, 4.0, 2.0};
  EXPECT_FALSE(overlap(first, second));
  EXPECT_NEAR(distance(first, second), 1.0, 1e-12);
}

// Second box turned by 90 degrees at (4, 0): spans x from 3 to 5; first ends at 2. Gap 1.
TEST(OrientedBox, GapAcross) {
  const OrientedBox first{{0, 0}, 0.0, 4.0, 2.0};
  const OrientedBox second{{4, 0}, core::kPi / 2, 4.0, 2.0};
  EXPECT_NEAR(distance(first, second), 1.0, 1e-12);
  const OrientedBox nearer{{2.9, 0}, core::kPi / 2, 4.0, 2.0};
  EXPECT_TRUE(overlap(first, nearer));
  EXPECT_EQ(distance(first, nearer), 0.0);
}

// A square of side 2 turned by 45 degrees has its corner at distance sqrt(2) from the center.
TEST(OrientedBox, CornerTowardEdge) {
  const OrientedBox first{{0, 0}, 0.0, 2.0, 2.0};
  const OrientedBox second{{1 + std::sqrt(2.0) + 0.5, 0}, core::kPi / 4, 2.0, 2.0};
  EXPECT_NEAR(distance(first, second), 0.5, 1e-12);
}

// The diagonal neighbors overlap in both axis projections of neither box: only the turned axes
// separate them.
TEST(OrientedBox, SeparatedOnlyByTurnedAxis) {
  const OrientedBox first{{0, 0}, 0.0, 2.0, 2.0};
  const OrientedBox second{{1.9, 1.9}, core::kPi / 4, 2.0, 2.0};
  EXPECT_FALSE(overlap(first, second));
}

TEST(OrientedBox, CornersRingAndContains) {
  const OrientedBox box{{1, 2}, core::kPi / 2, 4.0, 2.0};
  const auto corners = box.corners();
  EXPECT_NEAR(corners[0].x(), 0.0, 1e-12);  // front-left of a box that looks north lies to the west
  EXPECT_NEAR(corners[0].y(), 4.0, 1e-12);
  EXPECT_NEAR(corners[1].x(), 2.0, 1e-12);
  EXPECT_NEAR(corners[2].y(), 0.0, 1e-12);
  EXPECT_TRUE(box.contains({1.5, 3.5}));
  EXPECT_FALSE(box.contains({2.5, 2.0}));
}

}  // namespace
}  // namespace cdiff::geometry
