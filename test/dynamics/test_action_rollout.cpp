// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "dynamics/action_rollout.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::dynamics {
namespace {

using traffic::kRolloutBrake;
using traffic::kRolloutHeading;
using traffic::kRolloutSpeed;
using traffic::kRolloutSteer;
using traffic::kRolloutThrottle;
using traffic::kRolloutX;
using traffic::kRolloutY;
using traffic::Rollout;

constexpr Eigen::Index kRows = 32;

/// Smooth parts of the response only: throttle off the step at 0.3, brake too weak to stop.
Rollout randomActions(std::uint32_t trial, Eigen::Index rows = kRows) {
  const core::RandomStream random(3, "actions");
  Rollout rollout = Rollout::Zero(rows, traffic::kRolloutColumns);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const auto element = static_cast<std::uint32_t>(3 * row);
    rollout(row, kRolloutThrottle) = random.uniform({0, trial}, element, 0.35, 0.95);
    rollout(row, kRolloutSteer) = random.uniform({0, trial}, element + 1, -0.5, 0.6);
    rollout(row, kRolloutBrake) = random.uniform({0, trial}, element + 2, 0.02, 0.4);
  }
  return rollout;
}

/// Fixed dJ/ds with both signs in every column.
Rollout stateWeights(std::uint32_t trial, Eigen::Index rows = kRows) {
  const core::RandomStream random(4, "weights");
  Rollout weights = Rollout::Zero(rows, traffic::kRolloutColumns);
  for (Eigen::Index i = 0; i < rows * traffic::kStateColumns; ++i) {
    weights(i / traffic::kStateColumns, i % traffic::kStateColumns) =
        random.uniform({0, trial}, static_cast<std::uint32_t>(i), -1.0, 1.0);
  }
  return weights;
}

/// J = sum of weight x state after a rollout.
double weighted(const ActionRollout& model, double speed, Rollout rollout, const Rollout& weights) {
  model.rollOut(speed, rollout);
  return (rollout.leftCols(traffic::kStateColumns).array() *
          weights.leftCols(traffic::kStateColumns).array())
      .sum();
}

double centralDifference(const ActionRollout& model, double speed, const Rollout& rollout,
                         const Rollout& weights, Eigen::Index row, int column) {
  constexpr double kStep = 1e-5;
  Rollout above = rollout;
  Rollout below = rollout;
  above(row, column) += kStep;
  below(row, column) -= kStep;
  return (weighted(model, speed, above, weights) - weighted(model, speed, below, weights)) /
         (2.0 * kStep);
}

/// Truncation: h^2 / 6 x J''' below 1e3 (lever of 50 m x (0.4 rad per unit of steer)^3 x 32 rows)
/// = 2e-8; rounding: J of 1e2 x 32 terms x 2e-16 / h = 6e-8.
void expectBackward(double speed, const Rollout& actions, std::uint32_t trial) {
  const ActionRollout model;
  Rollout rollout = actions;
  model.rollOut(speed, rollout);
  const Rollout weights = stateWeights(trial, rollout.rows());
  Rollout gradient = weights;
  model.backward(speed, rollout, gradient);
  EXPECT_EQ(gradient.leftCols(traffic::kStateColumns), weights.leftCols(traffic::kStateColumns));
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    for (const int column : {kRolloutThrottle, kRolloutSteer, kRolloutBrake}) {
      ASSERT_NEAR(gradient(row, column),
                  centralDifference(model, speed, rollout, weights, row, column), 1e-7)
          << "row " << row << ", column " << column << ", speed " << speed;
    }
  }
}

TEST(ActionRollout, StatesAreThoseOfTheBicycleModelBitForBit) {
  const BicycleModel bicycle;
  for (const double speed : {0.0, 3.0, 8.0, 15.0}) {
    Rollout rollout = randomActions(1);
    rollout(5, kRolloutBrake) = 1.0;
    rollout(6, kRolloutThrottle) = 0.1;
    ActionRollout().rollOut(speed, rollout);
    traffic::VehicleState state;
    state.speed = speed;
    for (Eigen::Index row = 0; row < kRows; ++row) {
      state = bicycle.step(state,
                           {rollout(row, kRolloutThrottle), rollout(row, kRolloutSteer),
                            rollout(row, kRolloutBrake)},
                           traffic::kRolloutStep);
      ASSERT_LT(std::abs(rollout(row, kRolloutHeading)), 3.0);  // the model wraps beyond pi
      ASSERT_EQ(rollout(row, kRolloutX), state.position.x());
      ASSERT_EQ(rollout(row, kRolloutY), state.position.y());
      ASSERT_EQ(rollout(row, kRolloutHeading), state.heading);
      ASSERT_EQ(rollout(row, kRolloutSpeed), state.speed);
    }
  }
}

TEST(ActionRollout, HeadingIsNotWrapped) {
  // Full left at constant 10 m/s: 10 sin(atan(1.0684 tan 0.3685)) / 1.418 = 2.70 rad/s x 3.2 s.
  Rollout rollout = Rollout::Zero(kRows, traffic::kRolloutColumns);
  rollout.col(kRolloutSteer).setOnes();
  ActionRollout().rollOut(10.0, rollout);
  const double slip = std::atan(1.4178275 / 1.327058485 * std::tan(0.36848336));
  EXPECT_NEAR(rollout(kRows - 1, kRolloutHeading), 10.0 * std::sin(slip) / 1.4178275 * 3.2, 1e-9);
}

TEST(ActionRollout, ActionsOutOfRangeCountAsClamped) {
  Rollout beyond = Rollout::Zero(4, traffic::kRolloutColumns);
  beyond.col(kRolloutThrottle).setConstant(1.5);
  beyond.col(kRolloutSteer).setConstant(-1.2);
  beyond.col(kRolloutBrake).setConstant(-0.3);
  Rollout at = beyond;
  at.col(kRolloutThrottle).setOnes();
  at.col(kRolloutSteer).setConstant(-1.0);
  at.col(kRolloutBrake).setZero();
  ActionRollout().rollOut(5.0, beyond);
  ActionRollout().rollOut(5.0, at);
  EXPECT_EQ(beyond.leftCols(traffic::kStateColumns), at.leftCols(traffic::kStateColumns));
}

TEST(ActionRollout, FullRightMirrorsFullLeft) {
  Rollout left = Rollout::Zero(kRows, traffic::kRolloutColumns);
  left.col(kRolloutSteer).setOnes();
  Rollout right = -left;
  ActionRollout().rollOut(10.0, left);
  ActionRollout().rollOut(10.0, right);
  EXPECT_EQ(left.col(kRolloutX), right.col(kRolloutX));
  EXPECT_EQ(left.col(kRolloutY), -right.col(kRolloutY));
  EXPECT_EQ(left.col(kRolloutHeading), -right.col(kRolloutHeading));
}

TEST(ActionRollout, BackwardPassIsTheDerivative) {
  for (std::uint32_t trial = 0; trial < 4; ++trial) {
    for (const double speed : {0.5, 4.0, 9.0, 16.0}) {
      expectBackward(speed, randomActions(trial), trial);
    }
  }
}

TEST(ActionRollout, BackwardPassKnowsTheCapOfTheBrake) {
  // 20 km/h and more: the fit asks for more than 8 m/s^2, so the brake's strength does not depend
  // on the speed; below about 1 m/s, reached in the last rows, it does.
  Rollout actions = randomActions(9, 20);
  actions.col(kRolloutThrottle).setConstant(0.1);
  actions.col(kRolloutBrake).setConstant(0.55);
  Rollout check = actions;
  ActionRollout().rollOut(9.0, check);
  ASSERT_GT(check(0, kRolloutSpeed), 6.0);
  ASSERT_LT(check(19, kRolloutSpeed), 1.0);
  ASSERT_GT(check(19, kRolloutSpeed), 0.05);
  expectBackward(9.0, actions, 9);
}

TEST(ActionRollout, FlatThrottleHasNoDerivative) {
  Rollout rollout = Rollout::Zero(3, traffic::kRolloutColumns);
  rollout.col(kRolloutThrottle) << 0.29, 0.5, 0.0;
  ActionRollout().rollOut(5.0, rollout);
  Rollout gradient = Rollout::Zero(3, traffic::kRolloutColumns);
  gradient.col(kRolloutSpeed).setConstant(-1.0);  // faster is better
  ActionRollout().backward(5.0, rollout, gradient);
  EXPECT_EQ(gradient(0, kRolloutThrottle), 0.0);
  EXPECT_LT(gradient(1, kRolloutThrottle), 0.0);
  EXPECT_EQ(gradient(2, kRolloutThrottle), 0.0);
}

TEST(ActionRollout, BoundsBlockOnlyDescentOutOfThem) {
  const ActionRollout model;
  Rollout rollout = Rollout::Zero(1, traffic::kRolloutColumns);
  rollout(0, kRolloutThrottle) = 1.2;
  model.rollOut(8.0, rollout);
  Rollout faster = Rollout::Zero(1, traffic::kRolloutColumns);
  faster(0, kRolloutSpeed) = -1.0;
  Rollout slower = -faster;
  model.backward(8.0, rollout, faster);
  model.backward(8.0, rollout, slower);
  EXPECT_EQ(faster(0, kRolloutThrottle), 0.0);  // it would have to exceed 1
  EXPECT_GT(slower(0, kRolloutThrottle), 0.0);
  EXPECT_EQ(faster(0, kRolloutBrake), 0.0);  // and the brake to fall below 0
  EXPECT_LT(slower(0, kRolloutBrake), 0.0);
}

TEST(ActionRollout, BackwardPassAddsToTheActionGradient) {
  Rollout rollout = randomActions(2, 6);
  ActionRollout().rollOut(6.0, rollout);
  Rollout alone = stateWeights(2, 6);
  ActionRollout().backward(6.0, rollout, alone);
  Rollout added = stateWeights(2, 6);
  added.rightCols(traffic::kActionColumns).setConstant(0.25);
  ActionRollout().backward(6.0, rollout, added);
  const auto difference = added - alone;
  EXPECT_LT((difference.rightCols(traffic::kActionColumns).array() - 0.25).abs().maxCoeff(), 1e-14);
}

TEST(BicycleModel, ResponsesAgreeWithTheStep) {
  const BicycleModel model;
  EXPECT_EQ(model.speedResponse(7.0, {0.6, 0.0, 0.1}).speed,
            model.step({{0.0, 0.0}, 0.0, 0.0, 7.0}, {0.6, 0.0, 0.1}, 0.05).speed);
  // A car that stops within the tick stays stopped whatever the pedals change.
  const SpeedResponse stopping = model.speedResponse(5e-4, {0.0, 0.0, 1.0});
  EXPECT_EQ(stopping.speed, 0.0);
  EXPECT_EQ(stopping.by_speed, 0.0);
  // Coasting: next = speed.
  EXPECT_EQ(model.speedResponse(0.0, {0.0, 0.0, 0.0}).by_speed, 1.0);
  EXPECT_EQ(model.slipResponse(0.3).slip, model.slip(0.3));
}

}  // namespace
}  // namespace cdiff::dynamics
