// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace cdiff::realism {

// Realism as Waymo's Sim Agents Challenge 2025 measures it: how likely logged values are under the
// histogram of simulated ones (docs/realism.md; bins, weights and pseudo-counts of
// challenge_2025_sim_agents_config).

/// What is compared, in the order of tables.
enum Feature : std::size_t {
  kLinearSpeed,
  kLinearAcceleration,
  kAngularSpeed,
  kAngularAcceleration,
  kNearestObject,
  kCollision,
  kTimeToCollision,
  kRoadEdge,
  kOffRoad,
  kRedLight,
};
inline constexpr std::size_t kFeatures = 10;

/// Histogram and weight of one feature (SI units).
struct FeatureDefinition {
  const char* key;      ///< in JSON and CSV
  const char* title;    ///< in tables
  double low;           ///< of the first bin; values below count there
  double high;          ///< of the last bin; values above count there
  int bins;             ///< of equal width
  double pseudo_count;  ///< added to each bin
  double weight;        ///< in the meta-metric; the weights of all features add up to 1
  bool indicator;       ///< "at any step": one value (0 or 1) for a course
  bool of_map;          ///< needs the map
};

/// All, by Feature.
const std::array<FeatureDefinition, kFeatures>& featureDefinitions();

/// What stands where there is no value: NaN.
inline constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
/// Values of one feature step by step, every 0.1 s; NaN at steps that have none.
using Series = std::vector<double>;
/// All features of one object over one course. Indicators are 0 or 1 at each step.
using Course = std::array<Series, kFeatures>;

/// Distribution of the simulated values of one feature.
class Histogram {
 public:
  explicit Histogram(const FeatureDefinition& feature);
  /// NaN is skipped.
  void add(double value);
  /// ln((count + pseudo-count) / (samples + bins x pseudo-count)) of the value's bin.
  double logProbability(double value) const;
  std::size_t samples() const { return samples_; }

 private:
  std::size_t binOf(double value) const;

  const FeatureDefinition& feature_;
  std::vector<double> counts_;  ///< with the pseudo-count
  std::size_t samples_ = 0;
};

/// Sum of ln likelihoods over logged values.
struct LikelihoodSum {
  double log_sum = 0.0;
  std::size_t n = 0;  ///< logged values

  void add(double log_probability);
  /// exp(log_sum / n); absent without values.
  std::optional<double> likelihood() const;
};
using LikelihoodSums = std::array<LikelihoodSum, kFeatures>;
using Likelihoods = std::array<std::optional<double>, kFeatures>;

/// Scores the log of one object under its rollouts. Steps: the values of all rollouts and steps
/// make one histogram, under which each logged value counts. Indicators: one value for each
/// rollout, "at any step at which the log has the object".
void addObject(const Course& logged, const std::vector<Course>& rollouts, LikelihoodSums& sums);

Likelihoods likelihoodsOf(const LikelihoodSums& sums);

/// Sum of weight x likelihood over the features that are there, divided by the sum of their
/// weights; absent without any.
std::optional<double> metaMetric(const Likelihoods& likelihoods);

/// Mean of each feature over those that have it.
Likelihoods meanOf(const std::vector<Likelihoods>& all);

/// Whether an indicator is 1 at any step at which `mask` has a value.
bool anyStep(const Series& indicator, const Series& mask);

}  // namespace cdiff::realism
