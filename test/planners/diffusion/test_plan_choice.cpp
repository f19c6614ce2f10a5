// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "planners/diffusion/diffusion_situation.h"

namespace cdiff::planners {
namespace {

using guidance::Score;
using traffic::Rollout;

/// Four rows at a lateral offset.
Rollout planAt(double offset) {
  Rollout plan = Rollout::Zero(4, traffic::kRolloutColumns);
  plan.col(traffic::kRolloutY).setConstant(offset);
  return plan;
}

const std::vector<Rollout> kPlans = {planAt(0.0), planAt(1.0), planAt(2.0)};

TEST(PlanChoice, TheLowestScoreWinsWithoutALastPlan) {
  EXPECT_EQ(choosePlan(kPlans, {{0, 3.0}, {0, 1.0}, {0, 2.0}}, std::nullopt, 0.1), 1U);
}

TEST(PlanChoice, TheNearestToTheLastPlanStaysUntilAnotherIsClearlyBetter) {
  const Rollout last = planAt(1.9);
  EXPECT_EQ(choosePlan(kPlans, {{0, 3.0}, {0, 1.82}, {0, 2.0}}, last, 0.1), 2U);
  EXPECT_EQ(choosePlan(kPlans, {{0, 3.0}, {0, 1.78}, {0, 2.0}}, last, 0.1), 1U);
  EXPECT_EQ(choosePlan(kPlans, {{0, 3.0}, {0, 1.99}, {0, 2.0}}, last, 0.0), 1U);
  EXPECT_EQ(choosePlan(kPlans, {{0, 2.0}, {0, 2.0}, {0, 2.0}}, last, 0.0), 2U) << "as good";
}

TEST(PlanChoice, NegativeScoresKeepTheirMargin) {
  const Rollout last = planAt(2.0);
  EXPECT_EQ(choosePlan(kPlans, {{0, 0.0}, {0, -10.5}, {0, -10.0}}, last, 0.1), 2U);
  EXPECT_EQ(choosePlan(kPlans, {{0, 0.0}, {0, -11.5}, {0, -10.0}}, last, 0.1), 1U);
}

TEST(PlanChoice, AnUndefinedObjectiveRanksBehindEveryDefinedOne) {
  const Rollout last = planAt(2.0);
  EXPECT_EQ(choosePlan(kPlans, {{0, 9.0}, {1, 1.0}, {1, 0.0}}, last, 1.0), 0U);
  EXPECT_EQ(choosePlan(kPlans, {{1, 9.0}, {1, 1.0}, {1, 2.0}}, std::nullopt, 0.1), 1U);
}

TEST(PlanChoice, APlanThatLeavesTheRoadRanksBehindOneThatDoesNot) {
  EXPECT_EQ(choosePlan(kPlans, {{0, 9.0, 0}, {0, 1.0, 2}, {0, 0.0, 1}}, std::nullopt, 0.1), 0U);
  EXPECT_EQ(choosePlan(kPlans, {{0, 9.0, 0}, {0, 9.0, 2}, {0, 9.0, 1}}, planAt(2.0), 1.0), 0U)
      << "the last plan is no reason to leave it";
  EXPECT_EQ(choosePlan(kPlans, {{0, 9.0, 3}, {0, 9.5, 1}, {0, 9.0, 1}}, planAt(1.0), 0.1), 1U);
}

TEST(PlanChoice, APlanThatIsNotFiniteIsNotTaken) {
  std::vector<Rollout> plans = kPlans;
  plans[0](2, 0) = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Score> equal(3);
  EXPECT_EQ(choosePlan(plans, equal, std::nullopt, 0.1), 1U);
  EXPECT_EQ(choosePlan(plans, equal, planAt(0.1), 0.1), 1U);
  for (Rollout& plan : plans) plan(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(choosePlan(plans, equal, std::nullopt, 0.1), 0U);
}

}  // namespace
}  // namespace cdiff::planners
