// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::geometry {
namespace {

// East for 10 m (rising to z = 1), then north for 10 m.
Polyline corner() { return Polyline({{0, 0, 0}, {10, 0, 1}, {10, 10, 1}}); }

TEST(Polyline, ArcLengthPointsAndHeadings) {
  const Polyline line = corner();
  EXPECT_DOUBLE_EQ(line.length(), 20.0);
  EXPECT_DOUBLE_EQ(line.pointAt(5.0).z(), 0.5);
  EXPECT_DOUBLE_EQ(line.pointAt(15.0).y(), 5.0);
  EXPECT_DOUBLE_EQ(line.headingAt(5.0), 0.0);
  EXPECT_DOUBLE_EQ(line.headingAt(15.0), core::kPi / 2);
  EXPECT_DOUBLE_EQ(line.pointAt(-1.0).x(), 0.0);
  EXPECT_DOUBLE_EQ(line.pointAt(99.0).y(), 10.0);
}

TEST(Polyline, ProjectionSignIsLeftPositive) {
  const Projection left = corner().project({4.0, 2.0});
  EXPECT_DOUBLE_EQ(left.arc_length, 4.0);
  EXPECT_DOUBLE_EQ(left.lateral_offset, 2.0);
  EXPECT_DOUBLE_EQ(left.elevation, 0.4);
  EXPECT_DOUBLE_EQ(corner().project({4.0, -3.0}).lateral_offset, -3.0);
}

// Outside the corner at (13, -4) the nearest point is the corner itself, 5 m away, on the right.
TEST(Polyline, ProjectionBeyondCornerKeepsDistance) {
  const Projection outside = corner().project({13.0, -4.0});
  EXPECT_DOUBLE_EQ(outside.distance, 5.0);
  EXPECT_DOUBLE_EQ(outside.lateral_offset, -5.0);
}

TEST(Polyline, ProjectionWithinWindow) {
  const Projection windowed = corner().project({0.0, 0.0}, 12.0, 20.0);
  EXPECT_DOUBLE_EQ(windowed.arc_length, 12.0);
}

TEST(Polyline, ProjectionNearAnArcLength) {
  // Nearest of all is arc length 13; 4 m ahead of 6 the window ends at 10, the corner.
  EXPECT_DOUBLE_EQ(corner().projectNear({10.0, 3.0}, 6.0, {5.0, 15.0}).arc_length, 13.0);
  EXPECT_DOUBLE_EQ(corner().projectNear({10.0, 3.0}, 6.0, {5.0, 4.0}).arc_length, 10.0);
  EXPECT_EQ(corner().around(18.0, {5.0, 15.0}), std::make_pair(13.0, 20.0));
  EXPECT_EQ(corner().around(3.0, {5.0, 15.0}), std::make_pair(0.0, 18.0));
}

TEST(Polyline, SliceAndResample) {
  const Polyline part = corner().slice(5.0, 15.0);
  EXPECT_DOUBLE_EQ(part.length(), 10.0);
  EXPECT_EQ(corner().resampled(5.0).size(), 5u);
  EXPECT_EQ(corner().resampled(6.0).size(), 5u);  // 0, 6, 12, 18 and the end
}

TEST(Polyline, BadInput) {
  EXPECT_THROW(Polyline({{0, 0, 0}}), core::InputError);
  EXPECT_THROW(Polyline({{0, 0, 0}, {0, 0, 1}}), core::InputError);
  EXPECT_THROW(Polyline({{0, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 1}}),
               core::InputError);
}

}  // namespace
}  // namespace cdiff::geometry
