// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "diffusion/linear_gaussian.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion::test {
namespace {

constexpr std::uint32_t kRuns = 1500;  // 18,000 cells: standard error of a mean <= 0.0075 s

/// Ten steps of first order in mode real_time.
SamplerOptions mode(const std::string& name) {
  SamplerOptions options;
  options.mode = name;
  if (name != "real_time") return options;
  options.solver = "ddim";
  options.clean_up_steps = 0;
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

// At k = 1 the posterior's weights are 1 and 0 and its noise is left out: what a denoiser is sure
// of (s = 0) comes out to the bit.
TEST(Sampler, TheLastStepAddsNoNoise) {
  const Moments moments = sampleMoments(mode("unguided"), 0.0, 0.0, 20);
  EXPECT_EQ(moments.mean, 0.0);
  EXPECT_EQ(moments.deviation, 0.0);
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

/// Four standard errors of the mean of kRuns x 12 independent cells.
double fourErrors(double deviation) { return 4.0 * deviation / std::sqrt(12.0 * kRuns); }

// A trust region too wide to act: the mean of the problem's own answer within 5 % and the sampling
// error. At s = 0.1 and w = 0.5, the least effect, that is 0.0099 +- 0.0019: not 0.
TEST(Sampler, RealTimeModeFindsTheExactMeanWhereTheTrustRegionDoesNotAct) {
  for (const double s : {1.0, 0.3, 0.1}) {
    for (const double w : {0.5, 5.0, 50.0}) {
      SamplerOptions options = mode("real_time");
      options.trust_region = 20.0;
      const Moments moments = sampleMoments(options, s, w, kRuns);
      const double exact = exactMean(s, w);
      const double tolerance = 0.05 * exact + fourErrors(moments.deviation);
      ASSERT_LT(tolerance, 0.2 * exact);  // no guidance at all does not pass
      EXPECT_NEAR(moments.mean, exact, tolerance) << "s " << s << " w " << w;
    }
  }
}

/// What a mode makes of the problem: spread of the prior, weight, the exact mean and deviation, and
/// those measured with this test's noise (18,000 cells).
struct BiasRow {
  double s, w, exact_mean, exact_deviation, mean, deviation;
};

/// The measured moments within four standard errors (of a deviation: deviation / sqrt(2 n)).
void expectRow(const BiasRow& row, const Moments& moments) {
  SCOPED_TRACE("s " + std::to_string(row.s) + " w " + std::to_string(row.w));
  EXPECT_NEAR(exactMean(row.s, row.w), row.exact_mean, 1e-4);
  EXPECT_NEAR(row.s / std::sqrt(1.0 + 2.0 * row.w * row.s * row.s), row.exact_deviation, 1e-4);
  EXPECT_NEAR(moments.mean, row.mean, fourErrors(row.deviation));
  EXPECT_NEAR(moments.deviation, row.deviation, fourErrors(row.deviation) / std::sqrt(2.0));
}

// Known bias of real_time by ddim over ten steps, trust_region 2 as shipped. Optima farther than
// some s away are not reached (s = 0.3 and 0.1 at w = 50), and ten DDIM steps draw too narrow a
// distribution: 0.89, 0.79 and 0.49 of the prior's deviation at s = 1, 0.3 and 0.1 without any
// guidance.
TEST(Sampler, RealTimeModeHasTheBiasOfTheTable) {
  const BiasRow rows[] = {
      {1.0, 0.0, 0.0, 1.0, 0.0, 0.889},           {1.0, 0.5, 0.5, 0.7071, 0.4892, 0.6228},
      {1.0, 5.0, 0.9091, 0.3015, 0.9005, 0.2442}, {1.0, 50.0, 0.9901, 0.0995, 0.9804, 0.0962},
      {0.3, 0.0, 0.0, 0.3, 0.0, 0.2377},          {0.3, 0.5, 0.0826, 0.2873, 0.0816, 0.2255},
      {0.3, 5.0, 0.4737, 0.2176, 0.4711, 0.1582}, {0.3, 50.0, 0.9, 0.0949, 0.7603, 0.1761},
      {0.1, 0.0, 0.0, 0.1, 0.0, 0.0491},          {0.1, 0.5, 0.0099, 0.0995, 0.0098, 0.0486},
      {0.1, 5.0, 0.0909, 0.0953, 0.0907, 0.0452}, {0.1, 50.0, 0.5, 0.0707, 0.2248, 0.0491}};
  ASSERT_EQ(SamplerOptions().trust_region, 2.0);
  for (const BiasRow& row : rows) {
    expectRow(row, sampleMoments(mode("real_time"), row.s, row.w, kRuns));
  }
}

// Known bias of a warm start (50 -> 5 steps, trust_region 2) whose previous plan knew no guidance,
// as after a change of the objectives: it follows a strong pull only in part within one decision.
TEST(Sampler, WarmStartUnderGuidanceHasTheBiasOfTheTable) {
  const BiasRow rows[] = {
      {1.0, 0.5, 0.5, 0.7071, 0.2415, 0.7469},     {1.0, 5.0, 0.9091, 0.3015, 0.6718, 0.4003},
      {1.0, 50.0, 0.9901, 0.0995, 0.8137, 0.3641}, {0.3, 0.5, 0.0826, 0.2873, 0.0648, 0.2283},
      {0.3, 5.0, 0.4737, 0.2176, 0.4012, 0.1624},  {0.3, 50.0, 0.9, 0.0949, 0.6565, 0.2074},
      {0.1, 0.5, 0.0099, 0.0995, 0.0094, 0.0487},  {0.1, 5.0, 0.0909, 0.0953, 0.0868, 0.0453},
      {0.1, 50.0, 0.5, 0.0707, 0.2155, 0.0491}};
  for (const BiasRow& row : rows) {
    const std::vector<Trajectory> previous = priorPlans(row.s, kRuns);
    const Moments moments = sampleMoments(mode("real_time"), row.s, row.w, kRuns, previous);
    expectRow(row, moments);
    EXPECT_GT(moments.mean, fourErrors(moments.deviation));  // but it does follow
  }
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

TEST(Sampler, SampleDoesNotDependOnItsNeighbors) {
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

/// Action cells that one vehicle draws in so many decisions, unguided.
std::vector<Trajectory> drawnByOneVehicle(const SamplerOptions& options, std::uint64_t vehicle,
                                          std::uint32_t decisions) {
  const NoiseSchedule schedule(100);
  const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, 1.0);
  const Sampler sampler(options, schedule, spread, core::RandomStream(7, "noise"));
  GaussianDenoiser denoiser(schedule, 1.0);
  LearnedStateBranch branch(denoiser);
  std::vector<SampleRequest> requests(decisions);
  for (std::uint32_t i = 0; i < decisions; ++i) requests[i].key = {vehicle, i, 0};
  denoiser.setContexts(std::vector<Context>(decisions));
  std::vector<Trajectory> drawn;
  for (const auto& sample : sampler.sample(denoiser, branch, requests, nullptr))
    drawn.push_back(sample.clean);
  return drawn;
}

// Over 500 vehicles x 12 cells the standard error of a correlation is at most 0.013.
TEST(Sampler, NoiseOfAVehicleIsCorrelatedAsAsked) {
  for (const char* name : {"real_time", "unguided"}) {
    for (const double correlation : {0.0, 0.6, 1.0}) {
      SamplerOptions options = mode(name);
      options.noise_correlation = correlation;
      double product = 0.0;
      double square = 0.0;
      for (std::uint64_t vehicle = 0; vehicle < 500; ++vehicle) {
        const auto drawn = drawnByOneVehicle(options, vehicle, 2);
        const auto first = drawn[0].rightCols<3>();
        product += first.cwiseProduct(drawn[1].rightCols<3>()).sum();
        square += first.squaredNorm();
      }
      EXPECT_NEAR(product / square, correlation, 0.05) << name;
    }
  }
}

// The mean square of 6000 normal values has a standard error of 0.018.
TEST(Sampler, CorrelatedNoiseStillDrawsThePriorAndDiffersByVehicle) {
  SamplerOptions options = mode("unguided");
  options.noise_correlation = 0.6;
  double square = 0.0;
  for (std::uint64_t vehicle = 0; vehicle < 500; ++vehicle)
    square += drawnByOneVehicle(options, vehicle, 1).front().rightCols<3>().squaredNorm();
  EXPECT_NEAR(square / (500.0 * 12.0), 1.0, 0.08);
  options.noise_correlation = 1.0;
  EXPECT_NE(drawnByOneVehicle(options, 1, 1).front(), drawnByOneVehicle(options, 2, 1).front());
  EXPECT_EQ(drawnByOneVehicle(options, 1, 2)[0], drawnByOneVehicle(options, 1, 2)[1]);
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
