// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "dynamics/action_rollout.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/diffusion/guided_batch.h"
#include "planners/diffusion/last_plan.h"
#include "planners/diffusion/plan_choice.h"
#include "planners/model_course.h"

namespace cdiff::planners {
namespace {

using traffic::ControlAction;

/// What a vehicle can execute, as dynamics::executableAction leaves it.
bool isExecutable(const ControlAction& action) {
  const bool one_pedal = action.throttle == 0.0 || action.brake == 0.0;
  return action.valid() && one_pedal && (action.brake == 0.0 || action.brake >= 0.05);
}

bool isFinitePlan(const planning::PlannedAction& planned) {
  for (const planning::RolloutPoint& point : planned.rollout) {
    const traffic::VehicleState& state = point.state;
    if (!state.position.allFinite() || !std::isfinite(state.heading + state.speed)) return false;
  }
  return planned.rollout.size() == 32;
}

void expectSamePlan(const planning::PlannedAction& left, const planning::PlannedAction& right) {
  EXPECT_EQ(left.action, right.action);
  ASSERT_EQ(left.rollout.size(), right.rollout.size());
  for (std::size_t i = 0; i < left.rollout.size(); ++i) {
    EXPECT_EQ(left.rollout[i].action, right.rollout[i].action) << i;
    EXPECT_EQ(left.rollout[i].state.position, right.rollout[i].state.position) << i;
    EXPECT_EQ(left.rollout[i].state.heading, right.rollout[i].state.heading) << i;
    EXPECT_EQ(left.rollout[i].state.speed, right.rollout[i].state.speed) << i;
  }
}

bool samePlan(const planning::PlannedAction& left, const planning::PlannedAction& right) {
  for (std::size_t i = 0; i < left.rollout.size(); ++i) {
    if (!(left.rollout[i].action == right.rollout[i].action)) return false;
    if (left.rollout[i].state.position != right.rollout[i].state.position) return false;
  }
  return true;
}

/// With the shipped model, which needs not be made first.
class DiffusionModes : public testing::ModelCourse {
 protected:
  static void SetUpTestSuite() {}
  static DiffusionOptions optionsOf(const std::string& mode = "real_time",
                                    const std::string& branch = "learned") {
    DiffusionOptions options;
    options.sampler.mode = mode;
    options.state_branch = branch;
    return options;
  }

  /// The plans of a new planner at tick 0.
  std::vector<planning::PlannedAction> firstPlans(const DiffusionOptions& options) {
    goTo(0);
    return makeDiffusion(options)->plan(snapshot_, tasks());
  }

  /// All plans must be what a vehicle can execute and come out again from another planner. Returns
  /// them.
  std::vector<planning::PlannedAction> expectPlans(const DiffusionOptions& options) {
    auto plans = firstPlans(options);
    const auto again = firstPlans(options);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(plans[i].fault, "");
      EXPECT_TRUE(isFinitePlan(plans[i]));
      for (const planning::RolloutPoint& point : plans[i].rollout)
        EXPECT_TRUE(isExecutable(point.action));
      expectSamePlan(plans[i], again[i]);
    }
    EXPECT_FALSE(samePlan(plans[0], plans[1]));
    return plans;
  }
};

/// Exact states are float32 in units of about 10 m: within two roundings of 2^-24 at the 30 m that
/// 3.2 s lead to at most, 4e-6 m. Those of the learned head are centimeters off.
constexpr double kRounding = 1e-5;
constexpr double kLearned = 0.01;

TEST_F(DiffusionModes, EachModeWithEachBranchPlansTheSameExecutableActionsTwice) {
  std::vector<planning::PlannedAction> seen;
  for (const char* mode : {"paper", "real_time", "unguided"}) {
    for (const char* branch : {"learned", "exact"}) {
      SCOPED_TRACE(std::string(mode) + " " + branch);
      for (const planning::PlannedAction& planned : expectPlans(optionsOf(mode, branch))) {
        if (branch == std::string("exact"))
          EXPECT_LT(planned.state_mismatch, kRounding);
        else
          EXPECT_GT(planned.state_mismatch, kLearned);
        if (planned.slot == 0) seen.push_back(planned);
      }
    }
  }
  // Every option reaches the plan: without guidance the branch changes its states alone.
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(samePlan(seen[i], seen[j])) << i << " " << j;
  }
}

/// A decision of one vehicle whose samples are drawn here once more, one by one as documented:
/// image conditioning, the objective `speed` alone.
class CandidateChoice : public DiffusionModes {
 protected:
  static constexpr std::int64_t kCandidates = 6;

  CandidateChoice() {
    guidance_ = guidance::GuidanceOptions();
    guidance_.find("speed").weight = 0.02;
    options_ = optionsOf();
    options_.conditioning = "image";
    options_.precision = "fp32";
    guidance_.candidates = kCandidates;
  }

  /// The candidates of the first CBV at a tick, metric, with their scores.
  void drawCandidates(std::uint64_t tick) {
    guidance::GuidanceScene scene;
    scene.state = snapshot_.vehicles[1].state;
    scene.drivable_area = &area_;
    scene.target_speed = 8.0;
    std::vector<std::unique_ptr<guidance::TotalObjective>> owned;
    std::vector<guidance::TotalObjective*> objectives;
    std::vector<diffusion::SampleRequest> requests(kCandidates);
    for (std::uint32_t i = 0; i < kCandidates; ++i) {
      owned.push_back(std::make_unique<guidance::TotalObjective>(guidance_, scene));
      objectives.push_back(owned.back().get());
      requests[i].key = {core::hashText("cbv30"), static_cast<std::uint32_t>(tick), 0};
      requests[i].candidate = i;
    }
    const auto precision = inference::precisionNamed(options_.precision, options_.isa, "precision");
    const std::vector<float> features =
        diffusion::ImageEncoder(model_, precision).encode(images_[0]);
    denoiser_.setContexts(
        std::vector<diffusion::Context>(kCandidates, {features, {}, scene.state.speed, {}, {}}));
    diffusion::LearnedStateBranch branch(denoiser_);
    GuidedBatch batch(model_.normalizer, objectives);
    plans_.clear();
    scores_.clear();
    for (const auto& sample : sampler_.sample(denoiser_, branch, requests, &batch)) {
      plans_.push_back(model_.normalizer.denormalize(sample.clean));
      scores_.push_back(owned.front()->score(plans_.back()));
    }
  }

  DiffusionOptions options_;
  diffusion::Model model_ = diffusion::loadModel("default");
  diffusion::NoiseSchedule schedule_{100};
  diffusion::CpuDenoiser denoiser_{model_};
  diffusion::Sampler sampler_{{}, schedule_, model_.spread, core::RandomStream(1, "diffusion")};
  std::vector<traffic::Rollout> plans_;
  std::vector<guidance::Score> scores_;
};

TEST_F(CandidateChoice, DrivesTheCandidateThatTheChoiceNames) {
  options_.hysteresis = 1.0;
  const auto planner = makeDiffusion(options_);
  std::optional<traffic::Rollout> previous;
  std::set<std::int64_t> chosen_ones;
  int kept = 0;
  for (std::uint64_t tick = 0; tick < 20; tick += 2) {
    goTo(tick);
    const planning::PlannedAction planned = planner->plan(snapshot_, {tasks()[0]})[0];
    drawCandidates(tick);
    const std::size_t chosen = choosePlan(plans_, scores_, previous, options_.hysteresis);
    EXPECT_EQ(planned.guidance.candidates, kCandidates);
    ASSERT_EQ(planned.guidance.chosen, static_cast<std::int64_t>(chosen)) << tick;
    ASSERT_EQ(planned.candidates.size(), static_cast<std::size_t>(kCandidates));
    EXPECT_TRUE(planned.candidates[chosen].chosen);
    EXPECT_EQ(planned.candidates[chosen].places[1], planned.rollout[9].state.position) << "at 1 s";
    EXPECT_EQ(planned.candidates[chosen].score, -scores_[chosen].value);
    const traffic::VehicleState& start = snapshot_.vehicles[1].state;
    for (Eigen::Index row = 0; row < plans_[chosen].rows(); ++row) {
      const planning::RolloutPoint& point = planned.rollout[static_cast<std::size_t>(row)];
      EXPECT_EQ(point.action, dynamics::executableAction(plans_[chosen], row));
      EXPECT_EQ(point.state.position,
                start.pose().toMap(plans_[chosen].row(row).head<2>().transpose()));
    }
    const auto best = std::min_element(scores_.begin(), scores_.end()) - scores_.begin();
    if (best != planned.guidance.chosen) ++kept;
    chosen_ones.insert(planned.guidance.chosen);
    previous = LastPlan(plans_[chosen], tick, start, &route_)
                   .continued(1.0, dynamics::ActionRollout(), start);
  }
  EXPECT_GT(chosen_ones.size(), 2U);  // not always one and the same index
  EXPECT_GT(kept, 0);                 // the hysteresis held a plan that is not the best
  EXPECT_LT(kept, 10);
}

TEST_F(CandidateChoice, WithoutHysteresisTheBestOfMoreIsNoWorse) {
  options_.hysteresis = 0.0;
  drawCandidates(0);
  const auto best = std::min_element(scores_.begin(), scores_.end()) - scores_.begin();
  const auto planned = makeDiffusion(options_)->plan(snapshot_, {tasks()[0]})[0];
  EXPECT_EQ(planned.guidance.chosen, best);
  EXPECT_NEAR(0.02 * planned.guidance.objectives[0].value, scores_[best].value, 1e-12);
}

class WarmStart : public DiffusionModes {
 protected:
  /// Plans at tick 0, moves the first CBV to the plan's first row and `jump` meters beyond, and
  /// plans at tick 2.
  planning::PlannedAction secondPlan(bool warm, double jump) {
    DiffusionOptions options = optionsOf();
    options.sampler.warm_start = warm;
    const auto planner = makeDiffusion(options);
    goTo(0);
    snapshot_.vehicles[1].state = start_;
    const auto first = planner->plan(snapshot_, tasks());
    snapshot_.vehicles[1].state = first[0].rollout[0].state;
    snapshot_.vehicles[1].state.position.x() += jump;
    goTo(2);
    const auto second = planner->plan(snapshot_, tasks());
    EXPECT_EQ(second[0].fault, "");
    return second[0];
  }

  traffic::VehicleState start_ = snapshot_.vehicles[1].state;
};

TEST_F(WarmStart, IsUsedWhereTheVehicleIsAsPlannedAndNotAfterAJump) {
  // 0.5 m is the most that counts as "where the plan said".
  EXPECT_FALSE(samePlan(secondPlan(false, 0.4), secondPlan(true, 0.4)));
  expectSamePlan(secondPlan(false, 0.6), secondPlan(true, 0.6));
}

TEST_F(WarmStart, VehiclesThatStartWarmAndColdShareADecision) {
  DiffusionOptions options = optionsOf();
  options.sampler.warm_start = true;
  const auto planner = makeDiffusion(options);
  const auto alone = makeDiffusion(options);
  const auto first = planner->plan(snapshot_, tasks());
  alone->plan(snapshot_, {tasks()[0]});
  snapshot_.vehicles[1].state = first[0].rollout[0].state;
  snapshot_.vehicles[2].state.position.x() += 5.0;  // not where its plan said
  goTo(2);
  const auto both = planner->plan(snapshot_, tasks());
  expectSamePlan(both[0], alone->plan(snapshot_, {tasks()[0]})[0]);
  EXPECT_EQ(both[1].vehicle_id, "cbv60");
  expectSamePlan(both[1], makeDiffusion(optionsOf())->plan(snapshot_, {tasks()[1]})[0]);
}

TEST_F(DiffusionModes, AClosedGateLeavesEveryBitOfThePlan) {
  // Trigger distance 40 m, width 10 m: closed for the CBV 60 m from the ego, open for the one 30 m
  // away. With `none` the closed objective is the only one that acts.
  const std::pair<const char*, const char*> cases[] = {
      {"paper", "none"}, {"real_time", "none"}, {"real_time", "safety_critical"}};
  for (const auto& [mode, profile] : cases) {
    SCOPED_TRACE(std::string(mode) + " " + profile);
    DiffusionOptions options = optionsOf(mode);
    options.conditioning = "image_route";  // else the objective decides it
    guidance_ = guidance::loadProfile(profile);
    guidance_.find("collision_seeking").weight = 0.0;
    const auto without = firstPlans(options);
    guidance_.find("collision_seeking") =
        std::move(guidance::loadProfile("safety_critical").find("collision_seeking"));
    const auto with = firstPlans(options);
    expectSamePlan(with[1], without[1]);
    EXPECT_FALSE(samePlan(with[0], without[0]));
  }
}

TEST(DiffusionOptions, WhatConditioningComesTo) {
  DiffusionOptions options;
  const auto natural = guidance::loadProfile("naturalistic");
  const auto attack = guidance::loadProfile("safety_critical");
  EXPECT_EQ(options.conditioningUnder(natural), "image_route");
  EXPECT_EQ(options.conditioningUnder(attack), "image");
  options.sampler.mode = "unguided";
  EXPECT_EQ(options.conditioningUnder(attack), "image_route");
  options.conditioning = "image";
  EXPECT_EQ(options.conditioningUnder(natural), "image");
}

TEST_F(DiffusionModes, ConditioningByGuidanceWithholdsTheRouteFromAttackersAlone) {
  const auto planOf = [this](const std::string& conditioning) {
    DiffusionOptions options = optionsOf();
    options.conditioning = conditioning;
    return makeDiffusion(options)->plan(snapshot_, tasks());
  };
  for (const std::string profile : {"naturalistic", "safety_critical"}) {
    SCOPED_TRACE(profile);
    guidance_ = guidance::loadProfile(profile);
    const auto chosen = planOf("by_guidance");
    const bool attacks = profile == "safety_critical";
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      EXPECT_TRUE(samePlan(chosen[i], planOf(attacks ? "image" : "image_route")[i]));
      EXPECT_FALSE(samePlan(chosen[i], planOf(attacks ? "image_route" : "image")[i]));
    }
  }
}

/// The ego drives out along y = 0 and comes back along y = 3; a CBV stands beside the place where
/// it began.
class EgoUnderWay : public DiffusionModes {
 protected:
  EgoUnderWay() {
    context_.ego_route = &there_and_back_;
    guidance_ = guidance::loadProfile("safety_critical");
  }

  /// Decision `number`, half a second and 10 m of ego route after the one before.
  void goToDecision(int number) {
    goTo(static_cast<std::uint64_t>(10 * number));
    const double way = 10.0 * number;
    traffic::VehicleState& ego = snapshot_.vehicles[0].state;
    ego.position = there_and_back_.path().extendedPoseAt(way).position;
    ego.heading = there_and_back_.path().headingAt(std::min(way, there_and_back_.length()));
    ego.speed = 20.0;
  }
  /// The ego is 8 m short of the end of its way back, 2.9 m beside its way out.
  static constexpr int kLast = 20;

  map::RoadNetwork loop_ = testing::makeNetwork(
      {{"loop", {{0, 0, 0}, {100, 0, 0}, {102, 1.45, 0}, {100, 2.9, 0}, {0, 2.9, 0}}}});
  map::Route there_and_back_ = testing::routeAlong(loop_, {"loop"});
};

TEST_F(EgoUnderWay, AGapWithoutCbvsDoesNotLoseIt) {
  const auto steady = makeDiffusion(optionsOf());
  const auto idle = makeDiffusion(optionsOf());
  const auto absent = makeDiffusion(optionsOf());
  std::vector<planning::PlannedAction> expected;
  for (int number = 0; number <= kLast; ++number) {
    goToDecision(number);
    const bool last = number == kLast;
    expected = steady->plan(snapshot_, {tasks()[0]});
    const auto after_idling = idle->plan(
        snapshot_, last ? std::vector{tasks()[0]} : std::vector<planning::PlanningTask>{});
    if (number == 0) absent->plan(snapshot_, {tasks()[0]});
    if (!last) continue;
    ASSERT_EQ(expected[0].fault, "");
    expectSamePlan(after_idling[0], expected[0]);
    expectSamePlan(absent->plan(snapshot_, {tasks()[0]})[0], expected[0]);
  }
  // The place on the route does reach the plan: an ego that began a decision ago cannot be on its
  // way back, so it is taken for being on its way out there.
  const auto fresh = makeDiffusion(optionsOf());
  goToDecision(0);
  goTo(10 * kLast - 2);
  fresh->plan(snapshot_, {});
  goToDecision(kLast);
  EXPECT_FALSE(samePlan(fresh->plan(snapshot_, {tasks()[0]})[0], expected[0]));
}

TEST_F(DiffusionModes, TwoThreadsGiveTheBytesOfOne) {
  DiffusionOptions options = optionsOf();
  const auto one = expectPlans(options);
  options.threads = 2;
  const auto two = expectPlans(options);
  for (std::size_t i = 0; i < 2; ++i) expectSamePlan(one[i], two[i]);
  options.threads = 3;  // more than there are vehicles
  const auto three = expectPlans(options);
  for (std::size_t i = 0; i < 2; ++i) expectSamePlan(one[i], three[i]);
}

TEST_F(DiffusionModes, EachPrecisionPlansNearTheOther) {
  DiffusionOptions options = optionsOf();
  options.precision = "fp32";
  const auto exact = expectPlans(options);
  int narrow = 0;
  for (const std::string precision : {"bf16", "int8"}) {
    options.precision = precision;
    std::vector<planning::PlannedAction> plans;
    try {
      plans = expectPlans(options);
    } catch (const core::InputError&) {
      continue;  // not on this processor
    }
    ++narrow;
    EXPECT_FALSE(samePlan(plans[0], exact[0])) << precision << ": is that float32?";
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::Vector2d end = plans[i].rollout.back().state.position;
      // A sampled plan is about 1.1 m off the expert's over 3.2 s (model card).
      EXPECT_LT((end - exact[i].rollout.back().state.position).norm(), 1.1) << precision;
    }
  }
  if (narrow == 0) GTEST_SKIP() << "this processor has float32 alone";
}

}  // namespace
}  // namespace cdiff::planners
