// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "planners/course.h"
#include "planners/diffusion/plan_choice.h"
#include "support/random_model.h"

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

/// Candidates at a lateral offset of a vehicle in the middle of a road 3.2 m wide, along +x, where
/// each candidate's score is its cost by the objective `speed` alone.
class Candidates : public ::testing::Test {
 protected:
  Candidates() {
    situation_.scene.state = testing::vehicleAt("car", 0.0, 0.0, 0.0, 5.0).state;
    situation_.scene.drivable_area = &area_;
    situation_.scene.target_speed = 8.0;
    guidance_.find("speed").weight = 1.0;
    guidance_.candidates = 2;
    for (int i = 0; i < 2; ++i)
      situation_.objectives.push_back(
          std::make_unique<guidance::TotalObjective>(guidance_, situation_.scene));
  }
  /// 32 rows with these planned speeds and actions.
  void add(double speed, double steer) {
    Rollout plan = Rollout::Zero(32, traffic::kRolloutColumns);
    plan.col(traffic::kRolloutSpeed).setConstant(speed);
    plan.col(traffic::kRolloutThrottle).setConstant(0.5);
    plan.col(traffic::kRolloutSteer).setConstant(steer);
    samples_.push_back({model_.normalizer.normalize(plan), 4, 1});
  }
  ChosenPlan chosen() const {
    return PlanChoice(guidance_, 0.1, model_.normalizer, exact_).among(samples_, 1, situation_);
  }

  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(-50.0, 0.0, 250.0, 0.0)}});
  map::DrivableArea area_{network_};
  guidance::GuidanceOptions guidance_;
  diffusion::Model model_ = cdiff::testing::randomDenoiser();
  dynamics::ActionRollout exact_;
  DiffusionSituation situation_;
  std::vector<diffusion::SampledTrajectory> samples_;
};

// The first sample is another vehicle's. J_speed is 32 (v - 8)^2 of the planned speeds.
TEST_F(Candidates, TheOneOfTheLowestObjectiveIsDriven) {
  add(8.0, 0.0);
  add(6.0, 0.0);
  add(7.0, 0.0);
  const ChosenPlan choice = chosen();
  EXPECT_EQ(choice.report.chosen, 1);
  EXPECT_EQ(choice.report.candidates, 2);
  EXPECT_EQ(choice.report.trust_region_share, 0.25) << "one of four guided steps";
  ASSERT_EQ(choice.report.objectives.size(), 1U);
  EXPECT_NEAR(choice.report.objectives[0].value, 32.0, 1e-4);
  EXPECT_NEAR(choice.plan(0, traffic::kRolloutSpeed), 7.0, 1e-6);
}

TEST_F(Candidates, WhatIsDrivenIsWhatTheActionsDo) {
  add(0.0, 0.0);
  add(7.0, 0.3);
  add(6.0, 0.0);
  const ChosenPlan choice = chosen();
  Rollout expected = choice.plan;
  exact_.rollOut(5.0, expected);
  EXPECT_EQ(choice.driven, expected);
  EXPECT_GT(choice.driven(31, traffic::kRolloutY), 0.1) << "a left turn, which the plan hides";
}

TEST_F(Candidates, WithAHorizonThoseOnTheRoadComeFirst) {
  add(0.0, 0.0);
  add(7.0, 1.0);
  add(6.0, 0.0);
  EXPECT_EQ(chosen().report.chosen, 0);
  guidance_.road_horizon = 3.2;
  EXPECT_EQ(chosen().report.chosen, 1);
}

}  // namespace
}  // namespace cdiff::planners
