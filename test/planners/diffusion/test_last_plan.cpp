// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/course.h"
#include "planners/diffusion/last_plan.h"

namespace cdiff::planners {
namespace {

using traffic::Rollout;

traffic::VehicleState stateAt(double x, double y, double heading, double speed) {
  traffic::VehicleState state;
  state.position = {x, y};
  state.heading = heading;
  state.speed = speed;
  return state;
}

const traffic::VehicleState kStart = stateAt(100.0, 50.0, 0.5, 8.0);

/// 32 rows with throttle 0.01, 0.02 ... + 0.5, rolled out by the dynamics.
Rollout drivenPlan(const dynamics::ActionRollout& dynamics) {
  Rollout plan = Rollout::Zero(32, traffic::kRolloutColumns);
  for (Eigen::Index row = 0; row < plan.rows(); ++row) {
    plan(row, traffic::kRolloutThrottle) = 0.5 + 0.01 * static_cast<double>(row);
    plan(row, traffic::kRolloutSteer) = 0.1;
  }
  dynamics.rollOut(kStart.speed, plan);
  return plan;
}

/// Where the plan says the vehicle is after its first row.
traffic::VehicleState afterFirstRow(const Rollout& plan) {
  traffic::VehicleState state = kStart;
  state.position = kStart.pose().toMap(plan.row(0).head<2>().transpose());
  state.heading += plan(0, traffic::kRolloutHeading);
  state.speed = plan(0, traffic::kRolloutSpeed);
  return state;
}

TEST(LastPlan, GoesOnWhereTheVehicleDrivesAsPlanned) {
  const dynamics::ActionRollout dynamics;
  const Rollout plan = drivenPlan(dynamics);
  const LastPlan last(plan, 40, kStart, nullptr);
  const traffic::VehicleState now = afterFirstRow(plan);
  const auto next = last.continued(1.0, dynamics, now);
  ASSERT_TRUE(next);
  for (Eigen::Index row = 0; row + 1 < plan.rows(); ++row) {
    const Eigen::Vector2d planned = kStart.pose().toMap(plan.row(row + 1).head<2>().transpose());
    const Eigen::Vector2d seen = now.pose().toMap(next->row(row).head<2>().transpose());
    EXPECT_LT((planned - seen).norm(), 1e-9) << row;
  }
  EXPECT_EQ((*next)(31, traffic::kRolloutThrottle), plan(31, traffic::kRolloutThrottle));
  EXPECT_TRUE(last.holds(1, now, nullptr));
}

TEST(LastPlan, DoesNotHoldAfterAJump) {
  const dynamics::ActionRollout dynamics;
  const Rollout plan = drivenPlan(dynamics);
  const LastPlan last(plan, 40, kStart, nullptr);
  traffic::VehicleState now = afterFirstRow(plan);
  now.position.x() += 0.6;
  EXPECT_FALSE(last.holds(1, now, nullptr));
  now = afterFirstRow(plan);
  now.heading += 0.11;
  EXPECT_FALSE(last.holds(1, now, nullptr));
  now = afterFirstRow(plan);
  now.speed -= 0.6;
  EXPECT_FALSE(last.holds(1, now, nullptr));
}

TEST(LastPlan, HoldsAfterWhatIsNoJump) {
  const dynamics::ActionRollout dynamics;
  const Rollout plan = drivenPlan(dynamics);
  const LastPlan last(plan, 40, kStart, nullptr);
  for (const double sign : {-1.0, 1.0}) {
    traffic::VehicleState now = afterFirstRow(plan);
    now.position.y() += 0.45 * sign;
    now.heading += 0.09 * sign;
    now.speed += 0.45 * sign;
    EXPECT_TRUE(last.holds(1, now, nullptr));
    now = afterFirstRow(plan);
    now.position.y() += 0.55 * sign;
    EXPECT_FALSE(last.holds(1, now, nullptr));
    now = afterFirstRow(plan);
    now.heading += 0.11 * sign;
    EXPECT_FALSE(last.holds(1, now, nullptr));
    now = afterFirstRow(plan);
    now.speed += 0.55 * sign;
    EXPECT_FALSE(last.holds(1, now, nullptr));
  }
}

// Routes of one lane end at x = 100 m, or 0.4 and 0.6 m farther on.
TEST(LastPlan, HoldsForTheSameGoal) {
  const dynamics::ActionRollout dynamics;
  const Rollout plan = drivenPlan(dynamics);
  const traffic::VehicleState now = afterFirstRow(plan);
  const auto network = testing::makeNetwork({{"a", testing::straight(0.0, 0.0, 100.0, 0.0)},
                                             {"b", testing::straight(50.0, 0.0, 100.4, 0.0)},
                                             {"c", testing::straight(0.0, 0.0, 100.6, 0.0)}});
  const map::Route route = testing::routeAlong(network, {"a"});
  const map::Route near = testing::routeAlong(network, {"b"});
  const map::Route other = testing::routeAlong(network, {"c"});
  const LastPlan last(plan, 40, kStart, &route);
  EXPECT_TRUE(last.holds(1, now, &route));
  EXPECT_TRUE(last.holds(1, now, &near));
  EXPECT_FALSE(last.holds(1, now, &other));
  EXPECT_FALSE(last.holds(1, now, nullptr));
  EXPECT_FALSE(LastPlan(plan, 40, kStart, nullptr).holds(1, now, &route));
}

TEST(LastPlan, RepeatsItsLastRow) {
  const dynamics::ActionRollout dynamics;
  const Rollout plan = drivenPlan(dynamics);
  const LastPlan last(plan, 40, kStart, nullptr);
  EXPECT_FALSE(last.continued(0.0, dynamics, kStart));
  const auto next = last.continued(32.0, dynamics, kStart);
  ASSERT_TRUE(next);
  for (const Eigen::Index row : {0, 31})
    EXPECT_EQ((*next)(row, traffic::kRolloutThrottle), plan(31, traffic::kRolloutThrottle));
}

TEST(LastPlan, OnlyWholeRowsGoOn) {
  const dynamics::ActionRollout dynamics;
  const LastPlan last(drivenPlan(dynamics), 40, kStart, nullptr);
  EXPECT_FALSE(last.continued(0.5, dynamics, kStart));
  EXPECT_FALSE(last.continued(1.5, dynamics, kStart));
  EXPECT_FALSE(last.continued(33.0, dynamics, kStart));
  EXPECT_TRUE(last.continued(2.0, dynamics, kStart));
}

}  // namespace
}  // namespace cdiff::planners
