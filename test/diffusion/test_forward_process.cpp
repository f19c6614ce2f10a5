// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "diffusion/linear_gaussian.h"

namespace cdiff::diffusion {
namespace {

constexpr std::uint32_t kDraws = 20000;
constexpr double kClean = 0.7;  // tau^0

/// Mean and variance about the mean.
struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

Moments momentsOf(const std::vector<double>& values) {
  Moments moments;
  const auto count = static_cast<double>(values.size());
  for (const double value : values) moments.mean += value / count;
  for (const double value : values)
    moments.variance += (value - moments.mean) * (value - moments.mean) / (count - 1.0);
  return moments;
}

/// tau^k ~ N(sqrt(alpha_bar) tau^0, 1 - alpha_bar): of n draws the mean has the standard error
/// sqrt(variance / n) and the variance (normal draws) variance sqrt(2 / (n - 1)).
void expectClosedForm(const std::vector<double>& values, double alpha_bar) {
  const Moments moments = momentsOf(values);
  const auto count = static_cast<double>(values.size());
  const double variance = 1.0 - alpha_bar;
  EXPECT_NEAR(moments.mean, std::sqrt(alpha_bar) * kClean, 4.0 * std::sqrt(variance / count));
  EXPECT_NEAR(moments.variance, variance, 4.0 * variance * std::sqrt(2.0 / (count - 1.0)));
}

class ForwardProcess : public ::testing::Test {
 protected:
  double normal(std::uint32_t draw, std::uint32_t element) const {
    return noise_.normal({17, draw, 0}, element);
  }

  NoiseSchedule schedule_{100};
  core::RandomStream noise_{3, "forward"};
};

/// Keeps the first noisy batch that a sampler asks about.
class RecordingDenoiser : public test::GaussianDenoiser {
 public:
  using GaussianDenoiser::GaussianDenoiser;
  void setContexts(const std::vector<Context>& contexts) override {
    count_ = contexts.size();
    first_.clear();
    GaussianDenoiser::setContexts(contexts);
  }
  void predictActions(const float* noisy, int k, float* actions) override {
    if (first_.empty()) first_.assign(noisy, noisy + count_ * test::kHorizon * 7);
    GaussianDenoiser::predictActions(noisy, k, actions);
  }
  std::vector<double> first() const { return {first_.begin(), first_.end()}; }

 private:
  std::size_t count_ = 0;
  std::vector<float> first_;
};

// The sampler noises a previous plan by the closed form in one jump.
TEST_F(ForwardProcess, OneJumpHasTheMomentsOfTheClosedForm) {
  constexpr std::size_t kRuns = kDraws / (test::kHorizon * 7);
  const Trajectory plan = Trajectory::Constant(test::kHorizon, 7, static_cast<float>(kClean));
  const traffic::Rollout spread = traffic::Rollout::Constant(test::kHorizon, 7, 1.0);
  for (const int k : {1, 10, 51, 91, 100}) {
    SCOPED_TRACE(k);
    SamplerOptions options;
    options.warm_start_step = k;
    options.warm_steps = 1;
    const Sampler sampler(options, schedule_, spread, noise_);
    RecordingDenoiser denoiser(schedule_, 1.0);
    LearnedStateBranch branch(denoiser);
    std::vector<SampleRequest> requests(kRuns);
    for (std::uint32_t i = 0; i < kRuns; ++i) {
      requests[i].key = {17, i, 0};
      requests[i].warm = &plan;
    }
    denoiser.setContexts(std::vector<Context>(kRuns));
    sampler.sample(denoiser, branch, requests, nullptr);
    ASSERT_EQ(denoiser.first().size(), kRuns * test::kHorizon * 7);
    expectClosedForm(denoiser.first(), schedule_.alphaBar(k));
  }
}

TEST_F(ForwardProcess, StepByStepItIsTheSameDistribution) {
  // tau^k = sqrt(1 - beta_k) tau^{k-1} + sqrt(beta_k) eps_k. It fails for noise that is not
  // independent between steps (elements) and for a beta that does not fit alpha_bar.
  std::vector<double> values(kDraws, kClean);
  for (int k = 1; k <= 100; ++k) {
    const double beta = schedule_.beta(k);
    for (std::uint32_t draw = 0; draw < kDraws; ++draw) {
      values[draw] = std::sqrt(1.0 - beta) * values[draw] +
                     std::sqrt(beta) * normal(draw, static_cast<std::uint32_t>(k));
    }
    SCOPED_TRACE(k);
    if (k % 10 == 0 || k < 4) expectClosedForm(values, schedule_.alphaBar(k));
  }
}

}  // namespace
}  // namespace cdiff::diffusion
