// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/measures/wasserstein.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <boost/sort/pdqsort/pdqsort.hpp>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "metrics/measures/shapiro_wilk.h"

namespace cdiff::metrics {
namespace {

bool allFinite(const std::vector<double>& samples) {
  return !samples.empty() && std::all_of(samples.begin(), samples.end(),
                                         [](double sample) { return std::isfinite(sample); });
}

/// Integral of the standard normal distribution function from -infinity to z: z Phi(z) + phi(z).
double distributionIntegral(double z) {
  const double share = 0.5 * std::erfc(-z / std::sqrt(2.0));
  return z * share + std::exp(-0.5 * z * z) / std::sqrt(2.0 * core::kPi);
}

/// Integral of |share - Phi(z)| from begin to end, 0 < share < 1.
double differenceIntegral(double share, double begin, double end) {
  const double crossing = std::clamp(normalQuantile(share), begin, end);
  const double below =
      share * (crossing - begin) - (distributionIntegral(crossing) - distributionIntegral(begin));
  const double above =
      (distributionIntegral(end) - distributionIntegral(crossing)) - share * (end - crossing);
  return std::max(0.0, below) + std::max(0.0, above);
}

double meanDistance(const std::vector<double>& samples, double place) {
  double sum = 0.0;
  for (const double sample : samples) sum += std::abs(sample - place);
  return sum / static_cast<double>(samples.size());
}

}  // namespace

std::optional<double> wassersteinDistance(std::vector<double> first, std::vector<double> second) {
  if (!allFinite(first) || !allFinite(second)) return std::nullopt;
  boost::sort::pdqsort_branchless(first.begin(), first.end());
  boost::sort::pdqsort_branchless(second.begin(), second.end());
  const double first_share = 1.0 / static_cast<double>(first.size());
  const double second_share = 1.0 / static_cast<double>(second.size());
  std::size_t i = 0;
  std::size_t j = 0;
  double x = std::min(first.front(), second.front());
  double distance = 0.0;
  while (i < first.size() || j < second.size()) {
    const bool from_first = j == second.size() || (i < first.size() && first[i] <= second[j]);
    const double next = from_first ? first[i] : second[j];
    const double difference =
        static_cast<double>(i) * first_share - static_cast<double>(j) * second_share;
    distance += std::abs(difference) * (next - x);
    x = next;
    ++(from_first ? i : j);
  }
  return distance;
}

std::optional<double> wassersteinDistanceToNormal(std::vector<double> samples, double mean,
                                                  double standard_deviation) {
  if (!allFinite(samples) || !std::isfinite(mean) || !std::isfinite(standard_deviation) ||
      standard_deviation < 0.0) {
    return std::nullopt;
  }
  if (standard_deviation == 0.0) return meanDistance(samples, mean);
  for (double& sample : samples) sample = (sample - mean) / standard_deviation;
  std::sort(samples.begin(), samples.end());
  // Left of all samples the distance is Phi, right of them 1 - Phi(z) = Phi(-z).
  double distance = distributionIntegral(samples.front()) + distributionIntegral(-samples.back());
  const double count = static_cast<double>(samples.size());
  for (std::size_t i = 1; i < samples.size(); ++i)
    distance += differenceIntegral(static_cast<double>(i) / count, samples[i - 1], samples[i]);
  return standard_deviation * distance;
}

}  // namespace cdiff::metrics
