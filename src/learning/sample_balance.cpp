// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/sample_balance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::learning {
namespace {

constexpr double kSlow = 4.0;  // [m/s]
constexpr double kFast = 8.0;  // [m/s]

const char* paceOf(const DrivingSample& sample) {
  const auto speeds = sample.rollout.col(traffic::kRolloutSpeed);
  if (sample.speed < kStanding) {
    if (speeds.maxCoeff() < kStanding) return "standing";
    return "starting";
  }
  if (sample.speed > kMoving && speeds.minCoeff() < kStanding) return "stopping";
  if (sample.speed < kSlow) return "slow";
  return sample.speed < kFast ? "middle" : "fast";
}

}  // namespace

std::string balanceClass(const DrivingSample& sample) {
  constexpr const char* kManeuvers[] = {"straight ", "left ", "right ", "other "};
  return std::string(kManeuvers[std::min<std::size_t>(sample.maneuver, 3)]) + paceOf(sample);
}

std::vector<double> balanceWeights(const DrivingDataset& dataset, double balance,
                                   double yielding_share) {
  std::vector<std::string> classes;
  std::vector<double> weights;  // first the part of the sample that counts
  std::map<std::string, double> counts;
  for (const std::size_t index : dataset.training()) {
    const DrivingSample sample = dataset.withoutImage(index);
    classes.push_back(balanceClass(sample));
    weights.push_back(sample.stop_reason == kStopYielding ? yielding_share : 1.0);
    if (weights.back() > 0.0) counts[classes.back()] += weights.back();
  }
  const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!weights.empty() && all <= 0.0)
    throw core::InputError("training: all samples give way, and yielding_share is 0");
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] <= 0.0) continue;
    const double share = counts[classes[i]] * static_cast<double>(counts.size()) / all;
    weights[i] *= std::min(kMostWeight, std::pow(share, -balance));
    sum += weights[i];
  }
  for (double& weight : weights) weight *= static_cast<double>(weights.size()) / sum;
  return weights;
}

}  // namespace cdiff::learning
