// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "planners/rift/rift_reward.h"

namespace cdiff::planners {
namespace {

/// Along the line, on it, at a constant speed.
RiftStep atSpeed(double speed) {
  RiftStep step;
  step.speed = speed;
  return step;
}

// 0.5 x 0.25 for the heading and 0.6 x 0.05 x e^0.5 = 0.03 x 1.648721 for the place.
constexpr double kOnLine = 0.125 + 0.0494616;

TEST(RiftReward, StandingOnTheLineIsWorthHeadingAndPlace) {
  EXPECT_NEAR(riftReward(atSpeed(0.0)), kOnLine, 1e-6);
}

// 0.1 x 8 for the speed, - 0.1 for moving; none of the first at 3 m/s and at 20 m/s.
TEST(RiftReward, SpeedCountsBetweenThreeAndTwenty) {
  EXPECT_NEAR(riftReward(atSpeed(8.0)), kOnLine + 0.8 - 0.1, 1e-6);
  EXPECT_NEAR(riftReward(atSpeed(3.0)), kOnLine - 0.1, 1e-6);
  EXPECT_NEAR(riftReward(atSpeed(20.0)), kOnLine - 0.1, 1e-6);
}

TEST(RiftReward, ACollisionCostsTwentyAndTheSpeed) {
  RiftStep step = atSpeed(8.0);
  step.collides = true;
  EXPECT_NEAR(riftReward(step), kOnLine + 0.7 - 28.0, 1e-6);
}

TEST(RiftReward, OffTheRoadCostsFive) {
  RiftStep step = atSpeed(0.0);
  step.off_road = true;
  EXPECT_NEAR(riftReward(step), kOnLine - 5.0, 1e-6);
}

// Above 4 each costs 0.8; 4 itself does not. Any acceleration counts as moving, 0.1.
TEST(RiftReward, HarshnessCosts) {
  RiftStep step = atSpeed(0.0);
  step.acceleration = -4.0;
  EXPECT_NEAR(riftReward(step), kOnLine - 0.1, 1e-6);
  step.acceleration = -4.01;
  EXPECT_NEAR(riftReward(step), kOnLine - 0.9, 1e-6);
  step.yaw_acceleration = 4.01;
  EXPECT_NEAR(riftReward(step), kOnLine - 1.7, 1e-6);
}

// cos D = -1: 0.5 (-1 + 0.05 x (-8) + 0.25 (1 - 2)) = -0.825, and the 0.1 for moving.
TEST(RiftReward, AgainstTheLineIsPunishedAndThePlaceDoesNotCount) {
  RiftStep step = atSpeed(8.0);
  step.heading_error = core::kPi;
  step.offset = 3.0;
  EXPECT_NEAR(riftReward(step), -0.925, 1e-6);
}

// The place counts up to 60 degrees. 0.125 (1 - 59 / 90) = 0.0430556 for the heading, 0.0494616 for
// the place and 0.8 cos 59 = 0.4120305 for the speed; at 61 degrees 0.0402778 and 0.3878477.
TEST(RiftReward, AnObliqueHeadingIsWorthLessAndBeyondSixtyDegreesThePlaceIsNot) {
  RiftStep step = atSpeed(8.0);
  step.heading_error = core::degreesToRadians(59.0);
  EXPECT_NEAR(riftReward(step), 0.0430556 + 0.0494616 + 0.4120305 - 0.1, 1e-6);
  step.heading_error = core::degreesToRadians(-61.0);
  EXPECT_NEAR(riftReward(step), 0.0402778 + 0.3878477 - 0.1, 1e-6);
}

// 0.6 (1 - 0.05 / e^0.5) = 0.6 x 0.9696735, to either side.
TEST(RiftReward, AMeterBesideTheLineCosts) {
  for (const double offset : {1.0, -1.0}) {
    RiftStep step = atSpeed(0.0);
    step.offset = offset;
    EXPECT_NEAR(riftReward(step), 0.125 - 0.5818041, 1e-6);
  }
}

TEST(RiftReward, SmoothingKeepsQuadratics) {
  RiftSeries values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto t = static_cast<double>(i);
    values[i] = 3.0 - 2.0 * t + 0.5 * t * t;
  }
  const RiftSeries result = smoothed(values);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(result[i], values[i], 1e-9) << i;
}

// The weights of Savitzky and Golay for five points: -3, 12, 17, 12, -3 of 35.
TEST(RiftReward, SmoothingSpreadsAnImpulse) {
  RiftSeries values{};
  values[20] = 35.0;
  const RiftSeries result = smoothed(values);
  const double expected[] = {0.0, -3.0, 12.0, 17.0, 12.0, -3.0, 0.0};
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(result[17 + i], expected[i], 1e-9) << i;
}

// t^2 at 0, 0.1, ...: 2 t inside; one-sided at the ends, 0.1 and 7.9.
TEST(RiftReward, RatesAreCentralDifferences) {
  RiftSeries values{};
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = 0.01 * static_cast<double>(i) * static_cast<double>(i);
  const RiftSeries rates = rateOf(values);
  EXPECT_NEAR(rates[0], 0.1, 1e-9);
  EXPECT_NEAR(rates[7], 1.4, 1e-9);
  EXPECT_NEAR(rates[40], 7.9, 1e-9);
}

// Sum of 0.98^i over 40 steps: (1 - 0.98^40) / 0.02 = 27.71502.
TEST(RiftReward, AReturnIsDiscounted) {
  std::array<RiftStep, kRiftSteps> steps{};
  EXPECT_NEAR(riftReturn(steps), kOnLine * (1.0 - std::pow(0.98, 40.0)) / 0.02, 1e-5);
}

// Steps 0, 1 and 2 count: 1 + 0.98 + 0.9604 of kOnLine, and 0.9604 x 20.
TEST(RiftReward, AReturnEndsWithTheFirstCollision) {
  std::array<RiftStep, kRiftSteps> steps{};
  steps[2].collides = true;
  EXPECT_NEAR(riftReturn(steps), kOnLine * 2.9404 - 19.208, 1e-5);
}

}  // namespace
}  // namespace cdiff::planners
