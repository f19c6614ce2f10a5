// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "metrics/formulas/ttc_2d.h"

namespace cdiff::metrics {
namespace {

/// 4.8 m x 1.8 m, driving along its heading.
MovingBox car(double x, double y, double heading_degrees, double speed) {
  const double heading = core::degreesToRadians(heading_degrees);
  return {{{x, y}, heading, 4.8, 1.8}, speed * geometry::direction(heading)};
}

TEST(TimeToCollision2d, IsGapOverClosingSpeedInLine) {
  // Gap 20 - 4.8 = 15.2 m. Rear-end: 15.2 / 5 = 3.04 s. Head-on: 15.2 / 10 = 1.52 s.
  EXPECT_NEAR(*timeToCollision2d(car(0, 0, 0, 10), car(20, 0, 0, 5)), 3.04, 1e-12);
  EXPECT_NEAR(*timeToCollision2d(car(0, 0, 0, 5), car(20, 0, 180, 5)), 1.52, 1e-12);
}

TEST(TimeToCollision2d, TestsTheLongSides) {
  // From y = -20 northwards: 20 - 2.4 (half a length) - 0.9 (half a width) = 16.7 m at 10 m/s.
  EXPECT_NEAR(*timeToCollision2d(car(0, -20, 90, 10), car(0, 0, 0, 0)), 1.67, 1e-12);
}

TEST(TimeToCollision2d, IsTheLaterOfBothDirectionsWhenCrossing) {
  // Both fronts reach the other's near side, 0.9 m before the center, after 16.7 m.
  EXPECT_NEAR(*timeToCollision2d(car(0, -20, 90, 10), car(-20, 0, 0, 10)), 1.67, 1e-12);
  // From x = -28 the second's front comes to x = -0.9 after 24.7 m (2.47 s); the first's rear has
  // left y = 0.9 after 20 + 2.4 + 0.9 = 23.3 m (2.33 s).
  EXPECT_FALSE(timeToCollision2d(car(0, -20, 90, 10), car(-28, 0, 0, 10)).has_value());
}

TEST(TimeToCollision2d, TurnsTheSecondBox) {
  // Along x: 12 - 2.4 - (4.8 cos 20 + 1.8 sin 20) / 2 = 7.03692 m at 10 - 6 cos 20 = 4.36184
  // m/s: 1.61329 s. Along y the shadows overlap from 0.70 s on, so x decides.
  EXPECT_NEAR(*timeToCollision2d(car(0, 0, 0, 10), car(12, 4, -20, 6)), 1.6133, 5e-5);
}

TEST(TimeToCollision2d, IsAbsentWithoutContactAhead) {
  EXPECT_FALSE(timeToCollision2d(car(0, 0, 0, 10), car(20, 3.5, 0, 0)).has_value());  // next lane
  EXPECT_FALSE(timeToCollision2d(car(0, 0, 0, 5), car(20, 0, 0, 10)).has_value());    // draws away
  EXPECT_FALSE(timeToCollision2d(car(0, 0, 0, 10), car(-20, 0, 0, 5)).has_value());   // behind
  EXPECT_FALSE(timeToCollision2d(car(0, 0, 0, 0), car(20, 0, 0, 0)).has_value());     // both stand
}

// Both 4 m x 2 m, the second turned by 45 degrees. Along x the shadows, 2 + 3 / sqrt 2 = 4.1213 m
// to each side, overlap while |15 - 2 t| <= 4.1213: 5.44 to 9.56 s; along the second's heading, as
// long, while |-35 + 3 t| / sqrt 2 <= 4.1213: 9.72 to 13.61 s. The one is over when the other
// starts, though both axes across overlap then.
TEST(TimeToCollision2d, IsAbsentWhenOneShadowHasLeftBeforeAnotherComes) {
  const MovingBox first{{{0.0, 0.0}, 0.0, 4.0, 2.0}, {0.0, 0.0}};
  const MovingBox second{{{15.0, -50.0}, core::degreesToRadians(45.0), 4.0, 2.0}, {-2.0, 5.0}};
  EXPECT_FALSE(timeToCollision2d(first, second).has_value());
}

TEST(TimeToCollision2d, IsZeroWhenOverlapping) {
  EXPECT_EQ(timeToCollision2d(car(0, 0, 0, 10), car(3, 1, 0, 0)), 0.0);
  EXPECT_EQ(timeToCollision2d(car(0, 0, 0, 0), car(3, 1, 30, 0)), 0.0);
  EXPECT_EQ(timeToCollision2d(car(0, 0, 0, 5), car(3, 0, 0, 20)), 0.0);  // drawing apart
}

TEST(TimeToCollision2d, IsSymmetric) {
  const MovingBox first = car(0, 0, 0, 10);
  const MovingBox second = car(12, 4, -20, 6);
  EXPECT_NEAR(*timeToCollision2d(first, second), *timeToCollision2d(second, first), 1e-12);
}

TEST(TimeToCollision2d, IsAbsentForValuesThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(timeToCollision2d(car(nan, 0, 0, 10), car(20, 0, 0, 0)).has_value());
  EXPECT_FALSE(timeToCollision2d(car(0, 0, 0, 10), car(20, 0, 0, nan)).has_value());
  EXPECT_FALSE(riftTimeToCollision(car(0, 0, nan, 10), car(20, 0, 0, 0)).has_value());
  EXPECT_FALSE(longitudinalLateralTimeToCollision(car(0, nan, 0, 10), car(9, 0, 0, 0)).has_value());
  EXPECT_FALSE(rayCastTimeToCollision(car(0, 0, 0, 10), car(20, 0, nan, 0), OutlineOrder::kRing));
  EXPECT_FALSE(rayCastTimeToCollision(car(0, 0, nan, 10), car(20, 0, 0, 0), OutlineOrder::kRing));
}

TEST(RiftTimeToCollision, AgreesInLine) {
  EXPECT_DOUBLE_EQ(*riftTimeToCollision(car(0, 0, 0, 10), car(20, 0, 0, 5)), 3.04);
  EXPECT_DOUBLE_EQ(*riftTimeToCollision(car(0, 0, 0, 5), car(20, 0, 180, 5)), 1.52);
}

TEST(RiftTimeToCollision, HitsTheDiagonalInsteadOfTheLongSide) {
  // The front corners at x = +-0.9 meet the diagonals y = +-0.375 x at y = -0.3375: 17.6 - 0.3375
  // = 17.2625 m, 1.72625 s, rounded to 0.01 s (the true time is 1.67 s).
  EXPECT_DOUBLE_EQ(*riftTimeToCollision(car(0, -20, 90, 10), car(0, 0, 0, 0)), 1.73);
}

TEST(RayCastTimeToCollision, IsExactOnTheRingAndLateOnTheBowTie) {
  // The same pair: 1.726 s with RIFT's outline, 1.670 s with the box.
  const MovingBox first = car(0, -20, 90, 10);
  const MovingBox second = car(0, 0, 0, 0);
  EXPECT_NEAR(*rayCastTimeToCollision(first, second, OutlineOrder::kBowTie), 1.72625, 1e-12);
  EXPECT_NEAR(*rayCastTimeToCollision(first, second, OutlineOrder::kRing), 1.67, 1e-12);
  EXPECT_NEAR(*rayCastTimeToCollision(car(0, 0, 0, 10), car(12, 4, -20, 6), OutlineOrder::kRing),
              *timeToCollision2d(car(0, 0, 0, 10), car(12, 4, -20, 6)), 1e-12);
}

TEST(RiftApproachTime, IsCornerDistanceOverApproachSpeed) {
  // 15.2 m between the nearest corners at 5 m/s.
  EXPECT_DOUBLE_EQ(*riftApproachTime(car(0, 0, 0, 10), car(20, 0, 0, 5)), 3.04);
  // T-bone: corner (0.9, -17.6) to (2.4, -0.9): hypot(1.5, 16.7) = 16.7672 m at 10 m/s.
  EXPECT_DOUBLE_EQ(*riftApproachTime(car(0, -20, 90, 10), car(0, 0, 0, 0)), 1.68);
  // It does not ask whether the boxes would touch: next lane, 20 m ahead, 3.5 m aside.
  EXPECT_TRUE(riftApproachTime(car(0, 0, 0, 10), car(20, 3.5, 0, 0)).has_value());
  EXPECT_FALSE(riftApproachTime(car(0, 0, 0, 5), car(20, 0, 0, 10)).has_value());
  EXPECT_FALSE(riftApproachTime(car(0, 0, 0, 5), car(0, 0, 0, 5)).has_value());
}

TEST(RiftTimeToCollision, NeedsAnApproach) {
  EXPECT_FALSE(riftTimeToCollision(car(0, 0, 0, 5), car(20, 0, 0, 10)).has_value());
  EXPECT_FALSE(riftTimeToCollision(car(0, 0, 0, 0), car(20, 0, 0, 0)).has_value());
  EXPECT_FALSE(riftTimeToCollision(car(0, 0, 0, 10), car(20, 3.5, 0, 0)).has_value());
}

TEST(RiftTimeToCollision, PassesOverContactsWhoseCentersDrawApart) {
  // Two 12 m trucks side by side, the first faster by 3 m/s and drifting over at 0.5 m/s: the gap
  // 3 - 1.8 = 1.2 m closes in 2.4 s, while the trucks still overlap lengthwise (-1 - 7.2 = -8.2 m
  // of 12 m). Now -u . (v_B - v_A) is (3, 0.5) . (-1, 3) / |u| < 0.
  MovingBox first = car(0, 0, 0, 0);
  MovingBox second = car(-1, 3, 0, 0);
  first.box.length = second.box.length = 12.0;
  first.velocity = {3.0, 0.5};
  EXPECT_NEAR(*timeToCollision2d(first, second), 2.4, 1e-12);
  EXPECT_FALSE(riftTimeToCollision(first, second).has_value());
}

TEST(RiftTimeToCollision, IsZeroWhenACornerLiesInside) {
  EXPECT_EQ(riftTimeToCollision(car(0, 0, 0, 10), car(3, 0, 0, 0)), 0.0);
}

TEST(LongitudinalLateralTimeToCollision, TakesTheSmallerValidDirection) {
  // Longitudinal: 15.2 m at 5 m/s, lateral offset 0.
  EXPECT_NEAR(*longitudinalLateralTimeToCollision(car(0, 0, 0, 10), car(20, 0, 0, 5)), 3.04, 1e-12);
  // Lateral: 10 - (1.8 + 1.8) / 2 = 8.2 m at 2 m/s, longitudinal offset 0; the boxes count as
  // parallel.
  EXPECT_NEAR(*longitudinalLateralTimeToCollision(car(0, 0, 0, 0), car(0, 10, -90, 2)), 4.1, 1e-12);
  // From the left and ahead at 45 degrees toward the standing first: lateral gap 8.2 m at 5 m/s
  // in 1.64 s, when the second is at x = 10 - 5 x 1.64 = 1.8 (inside 4.8): valid. Longitudinal
  // gap 5.2 m in 1.04 s, when it is at y = 4.8: not valid.
  MovingBox diagonal = car(10, 10, 0, 0);
  diagonal.velocity = {-5.0, -5.0};
  EXPECT_NEAR(*longitudinalLateralTimeToCollision(car(0, 0, 0, 0), diagonal), 1.64, 1e-12);
}

TEST(LongitudinalLateralTimeToCollision, IsAbsentOrZero) {
  EXPECT_FALSE(
      longitudinalLateralTimeToCollision(car(0, 0, 0, 10), car(20, 3.5, 0, 0)).has_value());
  EXPECT_FALSE(longitudinalLateralTimeToCollision(car(0, 0, 0, 0), car(20, 0, 0, 0)).has_value());
  EXPECT_EQ(longitudinalLateralTimeToCollision(car(0, 0, 0, 10), car(3, 1, 0, 0)), 0.0);
}

}  // namespace
}  // namespace cdiff::metrics
