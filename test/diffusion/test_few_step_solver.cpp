// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "diffusion/few_step_solver.h"
#include "diffusion/linear_gaussian.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion::test {
namespace {

constexpr std::uint32_t kRuns = 1500;  // x 12 cells
const std::vector<int> kTen = {98, 88, 78, 69, 59, 49, 39, 29, 20, 10};
const std::vector<int> kTwelve = {98, 88, 78, 69, 59, 49, 39, 29, 20, 10, 5, 2};

SamplerOptions optionsOf(const std::string& solver, std::int64_t clean_up_steps) {
  SamplerOptions options;
  options.solver = solver;
  options.clean_up_steps = clean_up_steps;
  return options;
}

/// The solvers on one cell in double, from the equations: x0(tau, k) is the clean prediction that
/// is used, and the result the last of them.
double solveCell(const std::string& solver, const std::vector<int>& steps, double noise,
                 const std::function<double(double, int)>& x0) {
  const NoiseSchedule schedule(100);
  const auto signal = [&](int k) { return std::sqrt(schedule.alphaBar(k)); };
  const auto sigma = [&](int k) { return std::sqrt(1.0 - schedule.alphaBar(k)); };
  const auto lambda = [&](int k) { return std::log(signal(k)) - std::log(sigma(k)); };
  double tau = noise;
  double last_x = 0.0;
  double last_h = 0.0;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    const int k = steps[i];
    const int next = steps[i + 1];
    const double x = x0(tau, k);
    if (solver == "ddim") {
      tau = signal(next) * x + sigma(next) * (tau - signal(k) * x) / sigma(k);
      continue;
    }
    const double h = lambda(next) - lambda(k);
    const double data = i == 0 ? x : x + h / (2.0 * last_h) * (x - last_x);
    tau = sigma(next) / sigma(k) * tau + signal(next) * (1.0 - std::exp(-h)) * data;
    last_x = x;
    last_h = h;
  }
  return x0(tau, steps.back());
}

/// E[x | tau] of the prior N(0, s^2).
double gaussianMean(double s, double tau, int k) {
  const double ab = NoiseSchedule(100).alphaBar(k);
  return s * s * std::sqrt(ab) / (ab * s * s + 1.0 - ab) * tau;
}

// Of a linear denoiser the result is a number times the first noise, which is N(0, 1): that number
// is the deviation found. `share` of the prior's deviation s is that of the reference design's
// table, found there with 4,000 draws (two standard errors: 2.2 %) and printed with two decimals.
TEST(FewStepSolver, FindsTheSpreadOfGaussianPriors) {
  const struct {
    const char* solver;
    std::int64_t clean_up_steps;
    double s, share;
  } rows[] = {{"ddim", 0, 0.3, 0.78},     {"ddim", 0, 0.1, 0.48},     {"ddim", 0, 0.03, 0.17},
              {"ddim", 2, 0.3, 0.85},     {"ddim", 2, 0.1, 0.79},     {"ddim", 2, 0.03, 0.54},
              {"dpmpp_2m", 2, 0.3, 1.02}, {"dpmpp_2m", 2, 0.1, 0.91}, {"dpmpp_2m", 2, 0.03, 0.57}};
  for (const auto& row : rows) {
    SCOPED_TRACE(std::string(row.solver) + " s " + std::to_string(row.s));
    const double exact = solveCell(row.solver, row.clean_up_steps == 0 ? kTen : kTwelve, 1.0,
                                   [&](double tau, int k) { return gaussianMean(row.s, tau, k); });
    EXPECT_NEAR(exact / row.s, row.share, 0.022 * row.share + 0.005);
    const Moments moments =
        sampleMoments(optionsOf(row.solver, row.clean_up_steps), row.s, 0.0, kRuns);
    // Of a deviation over n = 18,000 cells: deviation / sqrt(2 n), four times.
    EXPECT_NEAR(moments.deviation, exact, 4.0 * exact / std::sqrt(2.0 * 12.0 * kRuns));
    EXPECT_NEAR(moments.mean, 0.0, 4.0 * exact / std::sqrt(12.0 * kRuns));
  }
}

/// The first noise of a cell, as the sampler draws it: diffusion step K + 1.
double firstNoise(const core::RandomKey& key, std::uint32_t cell) {
  core::RandomKey start = key;
  start.diffusion_step = 101;
  return core::RandomStream(7, "noise").normal(start, cell);
}

/// One sample under J = w (x - 1)^2 with a trust region that does not act.
Trajectory guidedSample(const std::string& solver, double s, double w) {
  const NoiseSchedule schedule(100);
  const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, s);
  SamplerOptions options = optionsOf(solver, 2);
  options.trust_region = 100.0;
  options.inner_iterations = 20;
  const Sampler sampler(options, schedule, spread, core::RandomStream(7, "noise"));
  GaussianDenoiser denoiser(schedule, s);
  LearnedStateBranch branch(denoiser);
  TargetOne objective(w);
  denoiser.setContexts(std::vector<Context>(1));
  return sampler.sample(denoiser, branch, {SampleRequest{}}, &objective).front().clean;
}

// The proximal step's answer on a cell, argmin w (x - 1)^2 + (x - x_hat)^2 / (2 r^2), is
// (x_hat + 2 w r^2) / (1 + 2 w r^2): with it as x of the recursion the result is the sampler's.
// Remembering x_hat in its place would be another number.
TEST(FewStepSolver, RemembersTheGuidedPrediction) {
  const double s = 0.3;
  const double w = 5.0;
  const NoiseSchedule schedule(100);
  const auto guided = [&](double tau, int k) {
    const double ab = schedule.alphaBar(k);
    const double pull = 2.0 * w * s * s * (1.0 - ab) / (ab * s * s + 1.0 - ab);
    return (gaussianMean(s, tau, k) + pull) / (1.0 + pull);
  };
  for (const char* solver : {"ddim", "dpmpp_2m"}) {
    const Trajectory sample = guidedSample(solver, s, w);
    for (std::uint32_t row = 0; row < kHorizon; ++row) {
      for (std::uint32_t column = 4; column < 7; ++column) {
        const double noise = firstNoise({}, 7 * row + column);
        // Twelve steps in float, each value below 3: 12 x 3 x 6e-8, and the descent's end.
        EXPECT_NEAR(sample(row, column), solveCell(solver, kTwelve, noise, guided), 1e-4) << solver;
      }
    }
  }
}

/// E[x | tau] of the prior of two equal peaks, the throttles "coast" and "hold" of the labels: 0
/// (deviation 0.015) and 0.46 (0.025), in the units of the shipped model, throttle = 0.5 + 0.5 x.
double pedalMean(double ab, double tau) {
  double weights = 0.0;
  double sum = 0.0;
  for (const auto& [mean, s] : {std::pair(-1.0, 0.03), std::pair(-0.08, 0.05)}) {
    const double variance = ab * s * s + 1.0 - ab;
    const double off = tau - std::sqrt(ab) * mean;
    const double weight = std::exp(-0.5 * off * off / variance) / std::sqrt(variance);
    weights += weight;
    sum += weight * (mean + s * s * std::sqrt(ab) / variance * off);
  }
  return sum / weights;
}

class PedalDenoiser : public GaussianDenoiser {
 public:
  explicit PedalDenoiser(const NoiseSchedule& schedule)
      : GaussianDenoiser(schedule, 1.0), schedule_(schedule) {}
  void setContexts(const std::vector<Context>& contexts) override {
    GaussianDenoiser::setContexts(contexts);
    rows_ = contexts.size() * kHorizon;
  }
  void predictActions(const float* noisy, int k, float* actions) override {
    for (std::size_t row = 0; row < rows_; ++row) {
      for (std::size_t c = 0; c < 3; ++c) {
        actions[row * 3 + c] =
            static_cast<float>(pedalMean(schedule_.alphaBar(k), noisy[row * 7 + 4 + c]));
      }
    }
  }

 private:
  const NoiseSchedule& schedule_;
  std::size_t rows_ = 0;
};

/// Share of sampled cells between the peaks: throttle above 0.06 and below 0.385, three deviations
/// from each and more.
double betweenPeaks(const SamplerOptions& options) {
  const NoiseSchedule schedule(100);
  const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, 0.5);
  const Sampler sampler(options, schedule, spread, core::RandomStream(7, "noise"));
  PedalDenoiser denoiser(schedule);
  LearnedStateBranch branch(denoiser);
  std::vector<SampleRequest> requests(kRuns);
  for (std::uint32_t i = 0; i < kRuns; ++i) requests[i].key = {1, i, 0};
  denoiser.setContexts(std::vector<Context>(kRuns));
  std::size_t between = 0;
  for (const SampledTrajectory& sample : sampler.sample(denoiser, branch, requests, nullptr)) {
    const auto cells = sample.clean.rightCols<3>().array();
    between += static_cast<std::size_t>((cells > -0.88F && cells < -0.23F).count());
  }
  return static_cast<double>(between) / (12.0 * kRuns);
}

// The prior has 0.07 % there. Shares of an independent program with 20,000 draws: 5.71 %, 0.74 %
// and 0.16 % (the reference design: 5.6 %, 1.7 % and 0.3 % with bounds of its own); within four
// standard errors of the difference to our 18,000 cells.
TEST(FewStepSolver, CleanLastStepsKeepTwoPeaksApart) {
  const double ddim_10 = betweenPeaks(optionsOf("ddim", 0));
  const double ddim_12 = betweenPeaks(optionsOf("ddim", 2));
  const double dpmpp_12 = betweenPeaks(optionsOf("dpmpp_2m", 2));
  EXPECT_NEAR(ddim_10, 0.0571, 0.0095);
  EXPECT_NEAR(ddim_12, 0.0074, 0.0035);
  EXPECT_NEAR(dpmpp_12, 0.0016, 0.0016);
  EXPECT_LT(dpmpp_12, ddim_12);
}

TEST(FewStepSolver, SameCallsSameBytesAndEachSampleAlone) {
  const NoiseSchedule schedule(100);
  const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, 0.3);
  const Sampler sampler(optionsOf("dpmpp_2m", 2), schedule, spread, core::RandomStream(7, "noise"));
  GaussianDenoiser denoiser(schedule, 0.3);
  LearnedStateBranch branch(denoiser);
  TargetOne objective(5.0);
  std::vector<SampleRequest> requests(3);
  for (std::uint32_t i = 0; i < 3; ++i) requests[i].key = {i, 4, 0};
  denoiser.setContexts(std::vector<Context>(3));
  const auto once = sampler.sample(denoiser, branch, requests, &objective);
  const auto again = sampler.sample(denoiser, branch, requests, &objective);
  denoiser.setContexts(std::vector<Context>(1));
  const auto alone = sampler.sample(denoiser, branch, {requests[2]}, &objective);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(once[i].clean, again[i].clean);
  EXPECT_EQ(once[2].clean, alone[0].clean);
  EXPECT_NE(once[1].clean, alone[0].clean);
}

TEST(FewStepSolver, CleanUpStepsHalve) {
  EXPECT_EQ(optionsOf("ddim", 0).visitedSteps(100, false), kTen);
  EXPECT_EQ(optionsOf("dpmpp_2m", 2).visitedSteps(100, false), kTwelve);
  EXPECT_EQ(optionsOf("dpmpp_2m", 1).visitedSteps(100, true),
            (std::vector<int>{50, 40, 30, 20, 10, 5}));
}

std::string errorOf(const SamplerOptions& options) {
  try {
    options.validate(100);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FewStepSolver, CleanUpStepsThatNobodyAskedForAreLeftOutWhereNothingCanBeHalved) {
  SamplerOptions options;
  options.steps = 98;
  EXPECT_EQ(errorOf(options), "");
  EXPECT_EQ(options.visitedSteps(100, false).back(), 1);
  EXPECT_EQ(options.visitedSteps(100, false).size(), 98U);
  options.steps = 40;  // ends at 2
  EXPECT_EQ(options.visitedSteps(100, false).size(), 41U);
}

TEST(FewStepSolver, WhatCannotTakeEffectIsRefused) {
  EXPECT_EQ(errorOf(optionsOf("dpmpp_2m", 3)), "");  // 5, 2, 1
  EXPECT_NE(errorOf(optionsOf("dpmpp_2m", 4))
                .find("clean_up_steps' is 4; the steps before end at "
                      "10, which can be halved 3 times"),
            std::string::npos);
  SamplerOptions paper;  // what is not asked for needs no refusal
  paper.mode = "paper";
  EXPECT_EQ(errorOf(paper), "");
  paper.solver = "ddim";
  EXPECT_NE(errorOf(paper).find("'diffusion.sampler.solver' is ddim; only mode real_time"),
            std::string::npos);
  paper = SamplerOptions();
  paper.clean_up_steps = 0;
  paper.mode = "unguided";
  EXPECT_NE(errorOf(paper).find("'diffusion.sampler.clean_up_steps' is 0; only mode"),
            std::string::npos);
  SamplerOptions warm = optionsOf("ddim", 3);
  warm.warm_start = true;
  warm.warm_steps = 10;  // 50 ... 5: two halvings
  EXPECT_NE(errorOf(warm).find("end at 5, which can be halved 2 times"), std::string::npos);
}

TEST(FewStepSolver, NamesAndTitlesAreOfOneTable) {
  for (const std::string& name : fewStepSolverNames()) {
    EXPECT_NE(makeFewStepSolver(name, NoiseSchedule(100)), nullptr);
    EXPECT_FALSE(fewStepSolverTitle(name).empty());
  }
  EXPECT_THROW(fewStepSolverTitle("euler"), std::invalid_argument);
}

}  // namespace
}  // namespace cdiff::diffusion::test
