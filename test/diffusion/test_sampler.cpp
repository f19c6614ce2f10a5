// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "diffusion/linear_gaussian.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion::test {
namespace {

constexpr std::uint32_t kRuns = 1500;  // 18,000 cells: standard error of a mean <= 0.0075 s

SamplerOptions mode(const std::string& name) {
  SamplerOptions options;
  options.mode = name;
  return options;
}

/// Product of N(0, s^2) and exp(-w (x - 1)^2): mean 2 w s^2 / (1 + 2 w s^2).
double exactMean(double s, double w) { return 2.0 * w * s * s / (1.0 + 2.0 * w * s * s); }

TEST(Sampler, UnguidedDdpmDrawsThePrior) {
  for (const double s : {1.0, 0.3}) {
    const Moments moments = sampleMoments(mode("unguided"), s, 50.0, kRuns);
    EXPECT_NEAR(moments.mean, 0.0, 0.03 * s);
    EXPECT_NEAR(moments.deviation, s, 0.03 * s);
  }
}

// Known bias of the paper's rule (mean - beta_k g, K = 100): it overshoots by up to 27 %. The means
// are those of an independent run of the same rule on the same problem (1500 samples there:
// standard error 0.026 s).
TEST(Sampler, PaperModeHasThePapersBias) {
  const struct {
    double s, w, mean;
  } cases[] = {{1.0, 0.5, 0.635}, {1.0, 50.0, 1.003}, {0.3, 0.5, 0.091},
               {0.3, 5.0, 0.599}, {0.3, 50.0, 1.003}, {0.1, 0.5, 0.013}};
  for (const auto& c : cases) {
    const Moments moments = sampleMoments(mode("paper"), c.s, c.w, kRuns);
    EXPECT_NEAR(moments.mean, c.mean, 0.08 * c.s) << "s " << c.s << " w " << c.w;
    EXPECT_GT(moments.mean, exactMean(c.s, c.w) - 0.03 * c.s);
  }
}

// The proximal step with the prior's own spread comes within 5 % of the exact mean, or 0.01.
TEST(Sampler, RealTimeModeFindsTheExactMean) {
  for (const double s : {1.0, 0.3, 0.1}) {
    for (const double w : {0.5, 5.0, 50.0}) {
      SamplerOptions options = mode("real_time");
      options.trust_region = 20.0;
      const Moments moments = sampleMoments(options, s, w, kRuns);
      EXPECT_NEAR(moments.mean, exactMean(s, w), std::max(0.05 * exactMean(s, w), 0.02))
          << "s " << s << " w " << w;
    }
  }
}

// DDIM over ten steps draws too narrow a distribution; how narrow is asserted, not hidden.
TEST(Sampler, RealTimeSpreadIsTooNarrow) {
  SamplerOptions options = mode("real_time");
  options.trust_region = 20.0;
  const Moments moments = sampleMoments(options, 0.3, 5.0, kRuns);
  const double exact = 0.3 / std::sqrt(1.0 + 2.0 * 5.0 * 0.09);  // 0.218
  EXPECT_LT(moments.deviation, exact);
  EXPECT_GT(moments.deviation, 0.7 * exact);
}

TEST(Sampler, TrustRegionLimitsTheShift) {
  SamplerOptions narrow = mode("real_time");
  narrow.trust_region = 0.05;
  SamplerOptions wide = mode("real_time");
  const double little = sampleMoments(narrow, 0.3, 50.0, 300).mean;
  EXPECT_GT(little, 0.0);
  EXPECT_LT(little, 0.3 * sampleMoments(wide, 0.3, 50.0, 300).mean);
}

TEST(Sampler, ObjectiveThatDoesNotActLeavesEveryBit) {
  for (const char* name : {"paper", "real_time"}) {
    const NoiseSchedule schedule(100);
    const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, 0.3);
    const Sampler sampler(mode(name), schedule, spread, core::RandomStream(7, "noise"));
    GaussianDenoiser denoiser(schedule, 0.3);
    LearnedStateBranch branch(denoiser);
    denoiser.setContexts(std::vector<Context>(1));
    TargetOne off(0.0);
    const std::vector<SampleRequest> requests(1);
    EXPECT_EQ(sampler.sample(denoiser, branch, requests, &off).front().clean,
              sampler.sample(denoiser, branch, requests, nullptr).front().clean);
  }
}

TEST(Sampler, SampleDoesNotDependOnItsNeighbours) {
  for (const char* name : {"paper", "real_time", "unguided"}) {
    const NoiseSchedule schedule(100);
    const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, 0.3);
    const Sampler sampler(mode(name), schedule, spread, core::RandomStream(7, "noise"));
    GaussianDenoiser denoiser(schedule, 0.3);
    LearnedStateBranch branch(denoiser);
    TargetOne objective(5.0);
    std::vector<SampleRequest> requests(3);
    for (std::uint32_t i = 0; i < 3; ++i) requests[i].key = {i, 4, 0};
    denoiser.setContexts(std::vector<Context>(3));
    const auto together = sampler.sample(denoiser, branch, requests, &objective);
    denoiser.setContexts(std::vector<Context>(1));
    const auto alone = sampler.sample(denoiser, branch, {requests[2]}, &objective);
    EXPECT_EQ(together[2].clean, alone[0].clean) << name;
    EXPECT_NE(together[1].clean, alone[0].clean) << name;
  }
}

TEST(Sampler, WarmStartStaysNearThePreviousPlan) {
  const NoiseSchedule schedule(100);
  const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, 1.0);
  const Sampler sampler(mode("real_time"), schedule, spread, core::RandomStream(7, "noise"));
  GaussianDenoiser denoiser(schedule, 1.0);
  LearnedStateBranch branch(denoiser);
  denoiser.setContexts(std::vector<Context>(400));
  const Trajectory plan = Trajectory::Constant(kHorizon, 7, 2.0F);
  std::vector<SampleRequest> requests(400);
  for (std::uint32_t i = 0; i < 400; ++i) {
    requests[i].key = {1, i, 0};
    requests[i].warm = &plan;
  }
  double sum = 0.0;
  for (const auto& sample : sampler.sample(denoiser, branch, requests, nullptr))
    sum += sample.clean.rightCols<3>().sum() / (3.0 * kHorizon * 400.0);
  // With s = 1 the exact denoiser of k = 50 keeps sqrt(ab) of the signal, ab_50 = 0.478, and DDIM
  // brings the rest back along the flow: well above the prior's mean of 0, below the plan's 2.
  EXPECT_GT(sum, 1.0);
  EXPECT_LT(sum, 2.0);
}

TEST(Sampler, RefusesMixedBatchesAndImpossibleSteps) {
  const NoiseSchedule schedule(100);
  const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, 1.0);
  const Sampler sampler(mode("real_time"), schedule, spread, core::RandomStream(7, "noise"));
  GaussianDenoiser denoiser(schedule, 1.0);
  LearnedStateBranch branch(denoiser);
  denoiser.setContexts(std::vector<Context>(2));
  const Trajectory plan = Trajectory::Zero(kHorizon, 7);
  std::vector<SampleRequest> requests(2);
  requests[1].warm = &plan;
  EXPECT_THROW(sampler.sample(denoiser, branch, requests, nullptr), std::invalid_argument);
  SamplerOptions too_many;
  too_many.steps = 101;
  EXPECT_THROW(too_many.validate(100), core::InputError);
  SamplerOptions too_far;
  too_far.warm_steps = 60;
  EXPECT_THROW(too_far.validate(100), core::InputError);
}

TEST(Sampler, VisitsFewStepsFromBelowTheTop) {
  const NoiseSchedule schedule(100);
  const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, 1.0);
  const Sampler sampler(mode("real_time"), schedule, spread, core::RandomStream(7, "noise"));
  EXPECT_EQ(sampler.visitedSteps(false),
            (std::vector<int>{98, 88, 78, 69, 59, 49, 39, 29, 20, 10}));
  EXPECT_EQ(sampler.visitedSteps(true), (std::vector<int>{50, 40, 30, 20, 10}));
}

}  // namespace
}  // namespace cdiff::diffusion::test
