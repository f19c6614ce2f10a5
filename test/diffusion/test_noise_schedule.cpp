// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "diffusion/noise_schedule.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

TEST(NoiseSchedule, ConstantsOfOneHundredSteps) {
  // Known values of the squared-cosine schedule at K = 100, there counted from 0 (our k is one
  // more), to the digits that are known.
  const NoiseSchedule schedule(100);
  EXPECT_EQ(schedule.steps(), 100);
  EXPECT_NEAR(schedule.beta(1), 0.000631, 5e-7);
  EXPECT_NEAR(schedule.beta(11), 0.00553, 5e-6);
  EXPECT_NEAR(schedule.beta(51), 0.0315, 5e-5);
  EXPECT_NEAR(schedule.beta(81), 0.0946, 5e-5);
  EXPECT_NEAR(schedule.beta(91), 0.189, 5e-4);
  EXPECT_NEAR(schedule.beta(96), 0.360, 5e-4);
  EXPECT_NEAR(schedule.beta(99), 0.750, 5e-4);
  EXPECT_EQ(schedule.beta(100), 0.999);
  EXPECT_NEAR(schedule.alphaBar(51), 0.478, 5e-4);
  EXPECT_NEAR(schedule.alphaBar(91), 0.0195, 5e-5);
  EXPECT_NEAR(schedule.alphaBar(99), 2.43e-4, 5e-7);
  EXPECT_NEAR(schedule.alphaBar(100), 2.43e-7, 5e-10);
  double sum = 0.0;
  for (int k = 1; k <= 100; ++k) sum += schedule.beta(k);
  EXPECT_NEAR(sum, 7.879, 5e-4);
}

TEST(NoiseSchedule, AlphaBarIsTheClosedForm) {
  // Below the cap the products telescope: alpha_bar(k) = f(k) / f(0).
  const NoiseSchedule schedule(100);
  const auto f = [](double k) {
    return std::pow(std::cos((k / 100.0 + 0.008) / 1.008 * std::acos(-1.0) / 2.0), 2);
  };
  EXPECT_EQ(schedule.alphaBar(0), 1.0);
  for (int k = 1; k < 100; ++k) EXPECT_NEAR(schedule.alphaBar(k), f(k) / f(0), 1e-13) << k;
}

TEST(NoiseSchedule, OneStep) {
  // 1 - alpha_bar(1) / alpha_bar(0) = 1 is capped at 0.999; the posterior is the clean sample.
  const NoiseSchedule schedule(1);
  EXPECT_EQ(schedule.beta(1), 0.999);
  EXPECT_NEAR(schedule.alphaBar(1), 0.001, 1e-15);
  EXPECT_NEAR(schedule.cleanWeight(1), 1.0, 1e-12);
  EXPECT_EQ(schedule.noisyWeight(1), 0.0);
}

TEST(NoiseSchedule, PosteriorWeightsOfTwoSteps) {
  // beta_1 = 1 - cos^2(0.508 / 1.008 pi/2) / cos^2(0.008 / 1.008 pi/2) = 0.5061564095593623,
  // beta_2 = 0.999; alpha_bar_1 = 0.4938435904, alpha_bar_2 = 0.0004938435904.
  // clean: sqrt(0.4938435904) 0.999 / 0.9995061564 = 0.7023841...;
  // noisy: sqrt(0.001) 0.5061564096 / 0.9995061564 = 0.01601405...
  const NoiseSchedule schedule(2);
  EXPECT_NEAR(schedule.beta(1), 0.5061564095593623, 1e-14);
  EXPECT_NEAR(schedule.cleanWeight(2), std::sqrt(0.4938435904406377) * 0.999 / 0.9995061564095594,
              1e-12);
  EXPECT_NEAR(schedule.noisyWeight(2), std::sqrt(0.001) * 0.5061564095593623 / 0.9995061564095594,
              1e-12);
}

TEST(NoiseSchedule, PosteriorKeepsMeanAndVariance) {
  // If tau^k ~ N(sqrt(alpha_bar_k) tau^0, 1 - alpha_bar_k), then a draw around the posterior mean
  // with the posterior variance (1 - alpha_bar_{k-1}) / (1 - alpha_bar_k) beta_k is
  // N(sqrt(alpha_bar_{k-1}) tau^0, 1 - alpha_bar_{k-1}).
  const NoiseSchedule schedule(100);
  for (int k = 1; k <= 100; ++k) {
    const double now = schedule.alphaBar(k);
    const double before = schedule.alphaBar(k - 1);
    const double noisy = schedule.noisyWeight(k);
    const double posterior = (1.0 - before) / (1.0 - now) * schedule.beta(k);
    EXPECT_NEAR(schedule.cleanWeight(k) + noisy * std::sqrt(now), std::sqrt(before), 1e-12) << k;
    EXPECT_NEAR(noisy * noisy * (1.0 - now) + posterior, 1.0 - before, 1e-12) << k;
  }
}

TEST(NoiseSchedule, RefusesNoSteps) {
  EXPECT_THROW(NoiseSchedule(0), core::InputError);
  EXPECT_THROW(NoiseSchedule(-3), core::InputError);
}

}  // namespace
}  // namespace cdiff::diffusion
