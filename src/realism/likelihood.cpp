// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/likelihood.h"

#include <algorithm>
#include <cmath>

namespace cdiff::realism {
namespace {

constexpr double kPseudoCount = 0.1;
constexpr double kIndicatorPseudoCount = 0.001;

/// Two bins around 0 and 1.
constexpr FeatureDefinition indicator(const char* key, const char* title, double weight,
                                      bool of_map) {
  return {key, title, -0.5, 1.5, 2, kIndicatorPseudoCount, weight, true, of_map};
}

void addSteps(const Series& logged, const std::vector<Course>& rollouts, std::size_t feature,
              LikelihoodSum& sum) {
  Histogram simulated(featureDefinitions()[feature]);
  for (const Course& rollout : rollouts) {
    for (const double value : rollout[feature]) simulated.add(value);
  }
  for (const double value : logged) {
    if (!std::isnan(value)) sum.add(simulated.logProbability(value));
  }
}

void addIndicator(const Series& logged, const std::vector<Course>& rollouts, std::size_t feature,
                  LikelihoodSum& sum) {
  const bool there =
      std::any_of(logged.begin(), logged.end(), [](double value) { return !std::isnan(value); });
  if (!there) return;
  Histogram simulated(featureDefinitions()[feature]);
  for (const Course& rollout : rollouts)
    simulated.add(anyStep(rollout[feature], logged) ? 1.0 : 0.0);
  sum.add(simulated.logProbability(anyStep(logged, logged) ? 1.0 : 0.0));
}

}  // namespace

const std::array<FeatureDefinition, kFeatures>& featureDefinitions() {
  static constexpr std::array<FeatureDefinition, kFeatures> kDefinitions = {{
      {"linear_speed", "linear speed", 0.0, 25.0, 10, kPseudoCount, 0.05, false, false},
      {"linear_acceleration", "linear acceleration", -12.0, 12.0, 11, kPseudoCount, 0.05, false,
       false},
      {"angular_speed", "angular speed", -0.628, 0.628, 11, kPseudoCount, 0.05, false, false},
      {"angular_acceleration", "angular acceleration", -3.14, 3.14, 11, kPseudoCount, 0.05, false,
       false},
      {"distance_to_nearest_object", "distance to the nearest object", -5.0, 40.0, 10, kPseudoCount,
       0.10, false, false},
      indicator("collision", "collision", 0.25, false),
      {"time_to_collision", "time to collision", 0.0, 5.0, 10, kPseudoCount, 0.10, false, false},
      {"distance_to_road_edge", "distance to the road's edge", -20.0, 40.0, 10, kPseudoCount, 0.05,
       false, true},
      indicator("off_road", "off-road", 0.25, true),
      indicator("red_light", "traffic-light violation", 0.05, true),
  }};
  return kDefinitions;
}

Histogram::Histogram(const FeatureDefinition& feature)
    : feature_(feature), counts_(static_cast<std::size_t>(feature.bins), feature.pseudo_count) {}

std::size_t Histogram::binOf(double value) const {
  const double clipped = std::clamp(value, feature_.low, feature_.high);
  const double width = (feature_.high - feature_.low) / feature_.bins;
  const auto bin = static_cast<std::size_t>((clipped - feature_.low) / width);
  return std::min(bin, counts_.size() - 1);
}

void Histogram::add(double value) {
  if (std::isnan(value)) return;
  counts_[binOf(value)] += 1.0;
  ++samples_;
}

double Histogram::logProbability(double value) const {
  const double total = static_cast<double>(samples_) + feature_.bins * feature_.pseudo_count;
  return std::log(counts_[binOf(value)] / total);
}

void LikelihoodSum::add(double log_probability) {
  log_sum += log_probability;
  ++n;
}

std::optional<double> LikelihoodSum::likelihood() const {
  if (n == 0) return std::nullopt;
  return std::exp(log_sum / static_cast<double>(n));
}

void addObject(const Course& logged, const std::vector<Course>& rollouts, LikelihoodSums& sums) {
  for (std::size_t i = 0; i < kFeatures; ++i) {
    const auto add = featureDefinitions()[i].indicator ? addIndicator : addSteps;
    add(logged[i], rollouts, i, sums[i]);
  }
}

Likelihoods likelihoodsOf(const LikelihoodSums& sums) {
  Likelihoods likelihoods;
  for (std::size_t i = 0; i < kFeatures; ++i) likelihoods[i] = sums[i].likelihood();
  return likelihoods;
}

std::optional<double> metaMetric(const Likelihoods& likelihoods) {
  double sum = 0.0;
  double weights = 0.0;
  for (std::size_t i = 0; i < kFeatures; ++i) {
    if (!likelihoods[i]) continue;
    sum += featureDefinitions()[i].weight * *likelihoods[i];
    weights += featureDefinitions()[i].weight;
  }
  if (weights == 0.0) return std::nullopt;
  return sum / weights;
}

Likelihoods meanOf(const std::vector<Likelihoods>& all) {
  Likelihoods mean;
  for (std::size_t i = 0; i < kFeatures; ++i) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const Likelihoods& one : all) {
      if (!one[i]) continue;
      sum += *one[i];
      ++count;
    }
    if (count > 0) mean[i] = sum / static_cast<double>(count);
  }
  return mean;
}

bool anyStep(const Series& indicator, const Series& mask) {
  const std::size_t steps = std::min(indicator.size(), mask.size());
  for (std::size_t i = 0; i < steps; ++i) {
    if (indicator[i] == 1.0 && !std::isnan(mask[i])) return true;
  }
  return false;
}

}  // namespace cdiff::realism
