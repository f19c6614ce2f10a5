// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/sample_order.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

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
  const std::size_t maneuver = std::min<std::size_t>(sample.maneuver, kManeuvers.size() - 1);
  return std::string(kManeuvers[maneuver]) + " " + paceOf(sample);
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

std::vector<std::size_t> drawEpoch(const std::vector<double>& weights,
                                   const core::RandomStream& random, std::int64_t epoch) {
  const core::RandomKey key{0, static_cast<std::uint32_t>(epoch)};
  std::vector<std::size_t> drawn;
  double reached = random.uniform(key, 0);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    for (; reached < sum && drawn.size() < weights.size(); reached += 1.0) drawn.push_back(i);
  }
  while (drawn.size() < weights.size()) drawn.push_back(weights.size() - 1);  // rounding
  for (std::size_t i = drawn.size(); i > 1; --i)
    std::swap(drawn[i - 1], drawn[random.index(key, static_cast<std::uint32_t>(i), i)]);
  return drawn;
}

SampleOrder::SampleOrder(std::vector<std::size_t> samples, std::vector<double> weights,
                         std::int64_t batch, const core::RandomStream& random)
    : samples_(std::move(samples)), weights_(std::move(weights)), batch_(batch), random_(random) {}

std::vector<std::size_t> SampleOrder::at(std::int64_t step) {
  const auto count = static_cast<std::int64_t>(samples_.size());
  std::vector<std::size_t> chosen;
  for (std::int64_t place = step * batch_; place < (step + 1) * batch_; ++place) {
    const std::int64_t epoch = place / count;
    if (epoch_ != epoch) {
      epoch_ = epoch;
      drawn_ = drawEpoch(weights_, random_, epoch);
    }
    chosen.push_back(samples_[drawn_[static_cast<std::size_t>(place % count)]]);
  }
  return chosen;
}

}  // namespace cdiff::learning
