// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/action_rollout.h"
#include "dynamics/throttle_response.h"

namespace cdiff::dynamics {
namespace {

using traffic::ControlAction;
using traffic::kRolloutSpeed;
using traffic::kRolloutThrottle;
using traffic::Rollout;

constexpr auto kMonotone = ThrottleResponse::kMonotone;
constexpr auto kFitted = ThrottleResponse::kFitted;

/// Acceleration over the tick of a commanded throttle [m/s^2].
double acceleration(ThrottleResponse response, double speed, double throttle) {
  const BicycleModel model;
  const ControlAction action = commandedAction(model, response, speed, {throttle, 0.0, 0.0});
  return (model.nextSpeed(speed, action) - speed) / BicycleModel::kTick;
}

// The reference design's figures of the fit: 0.30 brakes by 0.75, 1.09, 1.33 and 1.46 m/s^2 at 4,
// 6, 8 and 10 m/s; zero acceleration at 0.40, 0.43, 0.45 and 0.46.
TEST(ThrottleResponse, TheNotchIsWhereTheFitBrakes) {
  const struct {
    double speed, braking, zero;
  } rows[] = {{4.0, -0.75, 0.40}, {6.0, -1.09, 0.43}, {8.0, -1.33, 0.45}, {10.0, -1.46, 0.46}};
  const BicycleModel model;
  for (const auto& row : rows) {
    SCOPED_TRACE(row.speed);
    EXPECT_NEAR(acceleration(kFitted, row.speed, 0.30), row.braking, 0.005);
    EXPECT_EQ(pedalUse(model, row.speed, {0.0, 0.3, 0.0}), PedalUse::kCoasting);
    EXPECT_EQ(pedalUse(model, row.speed, {0.29, 0.0, 0.0}), PedalUse::kCoasting);
    EXPECT_EQ(pedalUse(model, row.speed, {0.30, 0.0, 0.0}), PedalUse::kNotch);
    EXPECT_EQ(pedalUse(model, row.speed, {row.zero - 0.006, 0.0, 0.0}), PedalUse::kNotch);
    EXPECT_EQ(pedalUse(model, row.speed, {row.zero + 0.006, 0.0, 0.0}), PedalUse::kDriving);
    EXPECT_EQ(pedalUse(model, row.speed, {row.zero + 0.006, 0.0, 0.05}), PedalUse::kBraking);
  }
  EXPECT_EQ(pedalUse(model, 0.0, {0.30, 0.0, 0.0}), PedalUse::kDriving);  // from standstill
}

TEST(ThrottleResponse, TheMonotoneOneNeverFallsAndTheFittedOneDoes) {
  for (const double speed : {0.0, 2.0, 4.0, 8.0, 12.0, 20.0}) {
    bool fell = false;
    for (int i = 1; i <= 1000; ++i) {
      const double throttle = i / 1000.0;
      const double before = throttle - 0.001;
      ASSERT_GE(acceleration(kMonotone, speed, throttle), acceleration(kMonotone, speed, before))
          << throttle << " at " << speed;
      fell = fell || acceleration(kFitted, speed, throttle) < acceleration(kFitted, speed, before);
    }
    EXPECT_EQ(fell, speed > 0.0) << speed;
  }
}

// No jump from coasting to driving: at 8 m/s the fit's slope at u_0 is below 20 m/s^2 per unit, so
// that 0.001 of throttle changes less than 0.02 m/s^2; the fitted one jumps by 1.33 at 0.30.
TEST(ThrottleResponse, TheMonotoneOneIsContinuous) {
  for (int i = 1; i <= 600; ++i) {
    const double step =
        acceleration(kMonotone, 8.0, i / 1000.0) - acceleration(kMonotone, 8.0, (i - 1) / 1000.0);
    ASSERT_LT(step, 0.02) << i / 1000.0;
  }
  EXPECT_NEAR(acceleration(kFitted, 8.0, 0.2999) - acceleration(kFitted, 8.0, 0.30), 1.33, 0.005);
}

TEST(ThrottleResponse, ChangesNothingButTheThrottleInTheNotch) {
  const BicycleModel model;
  const auto commanded = [&](ThrottleResponse response, const ControlAction& action) {
    return commandedAction(model, response, 8.0, action);
  };
  EXPECT_EQ(commanded(kMonotone, {0.35, 0.2, 0.1}), (ControlAction{0.0, 0.2, 0.1}));
  EXPECT_EQ(commanded(kFitted, {0.35, 0.2, 0.1}), (ControlAction{0.35, 0.2, 0.1}));
  for (const ControlAction& action :
       {ControlAction{0.2, 0.1, 0.0}, ControlAction{0.5, -0.1, 0.0}, ControlAction{0.0, 0.0, 0.7}})
    EXPECT_EQ(commanded(kMonotone, action), action);
}

TEST(ThrottleResponse, UnknownNamesAreRefused) {
  EXPECT_EQ(throttleResponse("fitted"), kFitted);
  EXPECT_EQ(throttleResponse("monotone"), kMonotone);
  EXPECT_THROW(throttleResponse("linear"), std::invalid_argument);
}

/// A rollout of one throttle from 8 m/s.
Rollout throttled(double throttle) {
  Rollout rollout = Rollout::Zero(8, traffic::kRolloutColumns);
  rollout.col(kRolloutThrottle).setConstant(throttle);
  return rollout;
}

double endSpeed(const ActionRollout& model, Rollout rollout) {
  model.rollOut(8.0, rollout);
  return rollout(rollout.rows() - 1, kRolloutSpeed);
}

TEST(ThrottleResponse, ARolloutDrivesAsItIsCommanded) {
  EXPECT_LT(endSpeed(ActionRollout(), throttled(0.4)), 7.9);
  EXPECT_NEAR(endSpeed(ActionRollout({}, kMonotone), throttled(0.4)), 8.0, 1e-12);
  EXPECT_EQ(endSpeed(ActionRollout({}, kMonotone), throttled(0.6)),
            endSpeed(ActionRollout(), throttled(0.6)));
}

// d(end speed)/d(throttle of a row) by central differences of 1e-5: J''' h^2 below 1e-8, rounding
// 8 x 2e-16 / 1e-5. In the notch (0.4) the monotone response is flat; above it (0.6) it is the
// fit's.
TEST(ThrottleResponse, TheGradientIsThatOfTheResponse) {
  constexpr double kStep = 1e-5;
  for (const ThrottleResponse response : {kFitted, kMonotone}) {
    const ActionRollout model({}, response);
    for (const double throttle : {0.2, 0.4, 0.6}) {
      Rollout rollout = throttled(throttle);
      model.rollOut(8.0, rollout);
      Rollout gradient = Rollout::Zero(8, traffic::kRolloutColumns);
      gradient(7, kRolloutSpeed) = 1.0;
      model.backward(8.0, rollout, gradient);
      for (Eigen::Index row = 0; row < 8; ++row) {
        Rollout above = throttled(throttle);
        Rollout below = above;
        above(row, kRolloutThrottle) += kStep;
        below(row, kRolloutThrottle) -= kStep;
        const double slope = (endSpeed(model, above) - endSpeed(model, below)) / (2.0 * kStep);
        ASSERT_NEAR(gradient(row, kRolloutThrottle), slope, 1e-7) << throttle << " row " << row;
        const bool flat = throttle < 0.3 || (throttle < 0.45 && response == kMonotone);
        ASSERT_EQ(gradient(row, kRolloutThrottle) == 0.0, flat) << throttle;
      }
    }
  }
}

}  // namespace
}  // namespace cdiff::dynamics
