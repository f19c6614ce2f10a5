// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/noise_schedule.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

constexpr double kOffset = 0.008;
constexpr double kMaxBeta = 0.999;

/// cos^2 of the schedule before the betas are capped, not divided by its value at 0.
double squaredCosine(int k, int steps) {
  const double fraction = static_cast<double>(k) / static_cast<double>(steps);
  const double cosine = std::cos((fraction + kOffset) / (1.0 + kOffset) * core::kPi / 2.0);
  return cosine * cosine;
}

}  // namespace

NoiseSchedule::NoiseSchedule(int steps) {
  if (steps < 1) {
    throw core::InputError("diffusion_steps is " + std::to_string(steps) +
                           "; at least 1 was expected");
  }
  beta_ = {0.0};
  alpha_bar_ = {1.0};
  for (int k = 1; k <= steps; ++k) {
    const double ratio = squaredCosine(k, steps) / squaredCosine(k - 1, steps);
    beta_.push_back(std::min(1.0 - ratio, kMaxBeta));
    alpha_bar_.push_back(alpha_bar_.back() * (1.0 - beta_.back()));
  }
}

double NoiseSchedule::cleanWeight(int k) const {
  return std::sqrt(alphaBar(k - 1)) * beta(k) / (1.0 - alphaBar(k));
}

double NoiseSchedule::noisyWeight(int k) const {
  return std::sqrt(1.0 - beta(k)) * (1.0 - alphaBar(k - 1)) / (1.0 - alphaBar(k));
}

}  // namespace cdiff::diffusion
