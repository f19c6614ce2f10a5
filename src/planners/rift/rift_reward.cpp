// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/rift_reward.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {
namespace {

constexpr double kRiftPeriod = 0.1;  // [s]
constexpr std::size_t kFitted = 5;   // neighbors in a fit

using FitWeights = std::array<double, kFitted>;

// Of the fitted quadratic at the first, the second and the middle one of five; over 35.
constexpr FitWeights kFirstWeights = {31.0, 9.0, -3.0, -5.0, 3.0};
constexpr FitWeights kSecondWeights = {9.0, 13.0, 12.0, 6.0, -5.0};
constexpr FitWeights kMiddleWeights = {-3.0, 12.0, 17.0, 12.0, -3.0};
constexpr double kWeightSum = 35.0;

/// `step` -1 reads backwards.
double fitted(const double* values, std::ptrdiff_t step, const FitWeights& weights) {
  double sum = 0.0;
  for (const double weight : weights) {
    sum += weight * *values;
    values += step;
  }
  return sum / kWeightSum;
}

}  // namespace

double riftReward(const RiftStep& step) {
  const double speed = std::abs(step.speed);
  const double along = std::cos(step.heading_error);
  const double offset = std::abs(step.offset);
  double reward = 0.0;
  if (step.collides) reward -= 20.0 + speed;
  if (step.off_road) reward -= 5.0;
  if (std::abs(step.acceleration) > 4.0) reward -= 0.8;
  if (std::abs(step.yaw_acceleration) > 4.0) reward -= 0.8;
  reward += 0.5 * (std::min(along, 0.0) + 0.05 * std::min(step.speed * along, 0.0) +
                   0.25 * (1.0 - std::abs(step.heading_error) / (0.5 * core::kPi)));
  if (along > 0.5) reward -= 0.6 * (offset - 0.05 / std::exp(offset - 0.5));
  if (speed > 3.0 && speed < 20.0) reward += 0.1 * std::max(along, 0.0) * speed;
  if (speed > 0.0 || step.acceleration != 0.0) reward -= 0.1;
  return reward;
}

RiftSeries smoothed(const RiftSeries& values) {
  RiftSeries result{};
  const std::size_t last = values.size() - 1;
  result[0] = fitted(&values[0], 1, kFirstWeights);
  result[1] = fitted(&values[0], 1, kSecondWeights);
  for (std::size_t i = 2; i + 2 <= last; ++i) result[i] = fitted(&values[i - 2], 1, kMiddleWeights);
  result[last - 1] = fitted(&values[last], -1, kSecondWeights);
  result[last] = fitted(&values[last], -1, kFirstWeights);
  return result;
}

RiftSeries rateOf(const RiftSeries& values) {
  RiftSeries result{};
  const std::size_t last = values.size() - 1;
  result[0] = (values[1] - values[0]) / kRiftPeriod;
  for (std::size_t i = 1; i < last; ++i)
    result[i] = (values[i + 1] - values[i - 1]) / (2.0 * kRiftPeriod);
  result[last] = (values[last] - values[last - 1]) / kRiftPeriod;
  return result;
}

double riftReturn(const std::array<RiftStep, kRiftSteps>& steps) {
  double sum = 0.0;
  double discount = 1.0;
  for (const RiftStep& step : steps) {
    sum += discount * riftReward(step);
    if (step.collides) break;
    discount *= kRiftDiscount;
  }
  return sum;
}

}  // namespace cdiff::planners
