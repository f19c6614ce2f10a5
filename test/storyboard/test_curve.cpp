// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Curves whose points are known: a circle, a clothoid's end heading, a straight and a round spline.
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "storyboard/curve.h"

namespace cdiff::storyboard {
namespace {

TEST(Curve, AConstantCurvatureIsACircle) {
  const MapPose start{{{10.0, 5.0}, 0.0}, 2.0};
  // A quarter of a circle of 20 m to the left ends 20 m ahead and 20 m to the left.
  const auto places = placesAlong({0.05, 0.0, 10.0 * core::kPi}, start);
  EXPECT_NEAR(places.back().pose.position.x(), 30.0, 0.01);
  EXPECT_NEAR(places.back().pose.position.y(), 25.0, 0.01);
  EXPECT_NEAR(places.back().pose.heading, 0.5 * core::kPi, 1e-9);
  EXPECT_EQ(places.back().elevation, 2.0);
  EXPECT_LE((places[1].pose.position - places[0].pose.position).norm(), 0.5 + 1e-9);
}

TEST(Curve, AClothoidTurnsWithTheSquareOfItsLength) {
  const auto places = placesAlong({0.0, 0.001, 30.0}, {{{0.0, 0.0}, 0.0}, 0.0});
  EXPECT_NEAR(places.back().pose.heading, 0.5 * 0.001 * 30.0 * 30.0, 1e-9);
}

TEST(Curve, ASplineOfOrderTwoIsItsPolyline) {
  const Spline spline{2, {1.0, 1.0, 1.0}, {0.0, 0.0, 1.0, 2.0, 2.0}};
  const auto points =
      pointsAlong(spline, {{0.0, 0.0, 0.0, 0.0}, {10.0, 0.0, 1.0, 2.0}, {10.0, 10.0, 1.0, 4.0}});
  EXPECT_TRUE(points.front().isApprox(TimedPoint(0.0, 0.0, 0.0, 0.0)));
  EXPECT_TRUE(points[points.size() / 2].isApprox(TimedPoint(10.0, 0.0, 1.0, 2.0)));
  EXPECT_TRUE(points.back().isApprox(TimedPoint(10.0, 10.0, 1.0, 4.0)));
}

// The quarter of a circle is the rational Bezier curve with the weight 1 / sqrt(2) in the middle.
TEST(Curve, WeightsMakeACircle) {
  const Spline spline{3, {1.0, std::sqrt(0.5), 1.0}, {0.0, 0.0, 0.0, 1.0, 1.0, 1.0}};
  for (const TimedPoint& point :
       pointsAlong(spline, {{1.0, 0.0, 0.0, 0.0}, {1.0, 1.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}}))
    EXPECT_NEAR(point.head<2>().norm(), 1.0, 1e-9);
}

}  // namespace
}  // namespace cdiff::storyboard
