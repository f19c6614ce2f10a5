// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "planners/pdm_lite/lateral_controller.h"
#include "planners/pdm_lite/longitudinal_controller.h"

namespace cdiff::planners {
namespace {

TEST(LookAhead, FollowsThePublishedLine) {
  EXPECT_NEAR(lookAheadDistance(0.0), 2.4, 1e-12);
  EXPECT_NEAR(lookAheadDistance(6.2), 2.4, 1e-12);
  // 0.97553 x 28.8 + 1.91529 = 30.01 points.
  EXPECT_NEAR(lookAheadDistance(8.0), 3.0, 1e-12);
  // 0.97553 x 54 + 1.91529 = 54.59 points.
  EXPECT_NEAR(lookAheadDistance(15.0), 5.4, 1e-12);
  EXPECT_NEAR(lookAheadDistance(40.0), 10.5, 1e-12);
}

TEST(LateralController, FirstStepIsTheSumOfAllThreeTerms) {
  // Aim 9 degrees to the left: error 0.1. kp 0.1 x 2 + ki 0.1 / 20 x 0.6406068 + kd 0.1 x 1.3782509
  // = 0.2 + 0.0032030 + 0.1378251 = 0.3410281, rounded to 0.341.
  LateralController controller;
  const double angle = core::degreesToRadians(9.0);
  const Eigen::Vector2d aim(std::cos(angle), std::sin(angle));
  EXPECT_DOUBLE_EQ(controller.steer({}, aim), 0.341);
  // The same again: no change, mean 0.2 / 20: 0.2 + 0.0064061 = 0.2064061.
  EXPECT_DOUBLE_EQ(controller.steer({}, aim), 0.206);
}

TEST(LateralController, OriginalConfigurationSteersHarder) {
  // 3.1183572 x 0.1 + 0.6406068 x 0.1 / 6 + 1.3782509 x 0.1 = 0.3118357 + 0.0106768 + 0.1378251.
  PdmLiteOptions options;
  options.configuration = "original";
  const double angle = core::degreesToRadians(9.0);
  const Eigen::Vector2d aim(std::cos(angle), std::sin(angle));
  EXPECT_DOUBLE_EQ(LateralController(options).steer({}, aim), 0.46);
  // A key that is given lies above the configuration: 0.1 + 0.0106768 + 0.1378251 = 0.2485019.
  options.lateral.kp = 1.0;
  EXPECT_DOUBLE_EQ(LateralController(options).steer({}, aim), 0.249);
}

TEST(LateralController, WindowForgetsOldErrors) {
  PdmLiteOptions options;
  options.lateral_window = 2;
  LateralController controller(options);
  const Eigen::Vector2d left(std::cos(core::degreesToRadians(9.0)),
                             std::sin(core::degreesToRadians(9.0)));
  controller.steer({}, left);
  controller.steer({}, {1.0, 0.0});
  // Window (0, 0) after the second straight call: nothing is left of the first error.
  EXPECT_DOUBLE_EQ(controller.steer({}, {1.0, 0.0}), 0.0);
}

TEST(LateralController, WrapsTheErrorAndLimitsTheSteer) {
  LateralController controller;
  // Heading 170 degrees, aim at -170 degrees: 20 degrees to the left, error 2/9; 2 + 0.032 + 1.378
  // times it = 0.7579.
  const double heading = core::degreesToRadians(170.0);
  const Eigen::Vector2d aim(std::cos(-heading), std::sin(-heading));
  EXPECT_DOUBLE_EQ(controller.steer({{0.0, 0.0}, heading}, aim), 0.758);
  EXPECT_DOUBLE_EQ(controller.steer({{0.0, 0.0}, 0.0}, {0.0, 1.0}), 1.0);
}

TEST(LateralController, CopyLeavesTheOriginalAlone) {
  LateralController controller;
  LateralController copy = controller;
  copy.steer({}, {1.0, 1.0});
  EXPECT_DOUBLE_EQ(controller.steer({}, {1.0, 0.0}), 0.0);
}

TEST(Pedals, SteadyThrottleIsAsPublished) {
  // At the target e = 0: 1.19903 c - 0.80576 c^2 with c = v_kmh / 100.
  EXPECT_NEAR(pedals(5.0, 5.0).throttle, 0.19, 0.005);
  EXPECT_NEAR(pedals(8.0, 8.0).throttle, 0.28, 0.005);
  EXPECT_NEAR(pedals(15.0, 15.0).throttle, 0.41, 0.005);
  EXPECT_NEAR(pedals(20.0, 20.0).throttle, 0.45, 0.005);
}

TEST(Pedals, FullThrottleFarBelowAndFullBrakeAboveTheTarget) {
  // 1.89 km/h = 0.525 m/s; 8 x 1.031266635 = 8.2501 m/s.
  EXPECT_EQ(pedals(8.0 - 0.526, 8.0).throttle, 1.0);
  // e = 0.18 km/h, c = 0.2862: 0.27716 + 0.30795 + 0.00000 + 0.00080 - 0.00010 = 0.5858.
  EXPECT_NEAR(pedals(8.0 - 0.05, 8.0).throttle, 0.5858, 1e-4);
  EXPECT_FALSE(pedals(8.249, 8.0).brake);
  EXPECT_TRUE(pedals(8.251, 8.0).brake);
  EXPECT_EQ(pedals(8.251, 8.0).throttle, 0.0);
}

TEST(Pedals, ZeroTargetBrakesAndSmallTargetsAreOneKmh) {
  EXPECT_TRUE(pedals(0.0, 0.0).brake);
  // Target 0.001 m/s counts as 1 km/h: from rest e = 1 km/h, 1.710818711 + 0.00009 limited to 1.
  EXPECT_FALSE(pedals(0.0, 0.001).brake);
  EXPECT_EQ(pedals(0.0, 0.001).throttle, 1.0);
}

// PDM-Lite brakes where there is no throttle below 0.5 m/s, lest the car rolls back on a slope.
TEST(Pedals, NeverCoastWhenSlow) {
  for (double speed = 0.0; speed < 0.5; speed += 0.01) {
    for (double target = 0.0; target < 20.0; target += 0.01) {
      const PedalCommand command = pedals(speed, target);
      ASSERT_TRUE(command.brake || command.throttle > 0.0) << speed << " to " << target;
    }
  }
}

TEST(ForecastThrottle, NeverBrakesAndRollsFarAboveTheTarget) {
  EXPECT_EQ(forecastThrottle(0.0, 8.0), 1.0);
  EXPECT_EQ(forecastThrottle(8.0 + 4.83 / 3.6, 8.0), 0.0);
  // 4.81 km/h above: c = 0.3361, 1.19903 x 0.3361 - 0.80576 x 0.3361^2 = 0.31197.
  EXPECT_NEAR(forecastThrottle(8.0 + 4.81 / 3.6, 8.0), 0.31197, 2e-5);
}

}  // namespace
}  // namespace cdiff::planners
