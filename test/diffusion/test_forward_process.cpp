// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/diffusion/noise_schedule.h"

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

TEST_F(ForwardProcess, OneJumpHasTheMomentsOfTheClosedForm) {
  for (const int k : {1, 10, 51, 91, 100}) {
    SCOPED_TRACE(k);
    const double alpha_bar = schedule_.alphaBar(k);
    std::vector<double> values;
    for (std::uint32_t draw = 0; draw < kDraws; ++draw) {
      values.push_back(std::sqrt(alpha_bar) * kClean +
                       std::sqrt(1.0 - alpha_bar) * normal(draw, static_cast<std::uint32_t>(k)));
    }
    expectClosedForm(values, alpha_bar);
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
