// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/distributions.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <initializer_list>
#include <numeric>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::metrics {

double normalQuantile(double probability) {
  return -std::sqrt(2.0) * boost::math::erfc_inv(2.0 * probability);
}

namespace {

/// c_0 + c_1 x + c_2 x^2 + ...
double polynomial(std::initializer_list<double> coefficients, double x) {
  double sum = 0.0;
  for (auto c = std::rbegin(coefficients); c != std::rend(coefficients); ++c) sum = sum * x + *c;
  return sum;
}

double normalUpperTail(double value) { return 0.5 * std::erfc(value / std::sqrt(2.0)); }

/// Royston's weights of the upper half of the ordered sample, the greatest value's first; the lower
/// half is its mirror image with the sign changed. A value in the middle has weight 0.
std::vector<double> weights(std::size_t n) {
  const std::size_t half = n / 2;
  if (n == 3) return {std::sqrt(0.5)};
  std::vector<double> scores(half);
  double sum_of_squares = 0.0;
  for (std::size_t i = 0; i < half; ++i) {
    scores[i] = -normalQuantile((static_cast<double>(i) + 0.625) / (static_cast<double>(n) + 0.25));
    sum_of_squares += 2.0 * scores[i] * scores[i];
  }
  const double u = 1.0 / std::sqrt(static_cast<double>(n));
  const double norm = std::sqrt(sum_of_squares);
  const std::size_t corrected = n > 5 ? 2 : 1;
  std::vector<double> result(half);
  result[0] =
      polynomial({scores[0] / norm, 0.221157, -0.147981, -2.071190, 4.434685, -2.706056}, u);
  if (corrected == 2) {
    result[1] =
        polynomial({scores[1] / norm, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633}, u);
  }
  double numerator = sum_of_squares;
  double denominator = 1.0;
  for (std::size_t i = 0; i < corrected; ++i) {
    numerator -= 2.0 * scores[i] * scores[i];
    denominator -= 2.0 * result[i] * result[i];
  }
  const double scale = std::sqrt(numerator / denominator);
  for (std::size_t i = corrected; i < half; ++i) result[i] = scores[i] / scale;
  return result;
}

/// W of an ordered sample whose values are not all equal.
double statistic(const std::vector<double>& ordered) {
  const std::size_t n = ordered.size();
  const std::vector<double> upper = weights(n);
  const double range = ordered.back() - ordered.front();
  const double mean = std::accumulate(ordered.begin(), ordered.end(), 0.0) / static_cast<double>(n);
  double squares = 0.0;
  for (const double value : ordered) {
    const double scaled = (value - mean) / range;
    squares += scaled * scaled;
  }
  double contrast = 0.0;
  for (std::size_t i = 0; i < upper.size(); ++i) {
    contrast += upper[i] * ((ordered[n - 1 - i] - ordered[i]) / range);
  }
  return std::min(1.0, contrast * contrast / squares);
}

/// Royston's approximations of the distribution of W.
double pValue(double w, std::size_t n) {
  if (n == 3) {
    const double p = 6.0 / core::kPi * (std::asin(std::sqrt(w)) - std::asin(std::sqrt(0.75)));
    return std::clamp(p, 0.0, 1.0);
  }
  const double size = static_cast<double>(n);
  double y = std::log(1.0 - w);
  if (n <= 11) {
    const double limit = polynomial({-2.273, 0.459}, size);
    if (y >= limit) return 0.0;
    y = -std::log(limit - y);
    const double mean = polynomial({0.5440, -0.39978, 0.025054, -0.0006714}, size);
    const double deviation = std::exp(polynomial({1.3822, -0.77857, 0.062767, -0.0020322}, size));
    return normalUpperTail((y - mean) / deviation);
  }
  const double x = std::log(size);
  const double mean = polynomial({-1.5861, -0.31082, -0.083751, 0.0038915}, x);
  const double deviation = std::exp(polynomial({-0.4803, -0.082676, 0.0030302}, x));
  return normalUpperTail((y - mean) / deviation);
}

std::string reasonAgainst(const std::vector<double>& ordered) {
  const std::string count = "n = " + std::to_string(ordered.size());
  if (ordered.size() < kShapiroWilkLeast) {
    return count + ", needs at least " + std::to_string(kShapiroWilkLeast);
  }
  if (ordered.size() > kShapiroWilkMost) {
    return count + ", defined up to " + std::to_string(kShapiroWilkMost);
  }
  if (ordered.front() == ordered.back()) return "all values are equal";
  return {};
}

}  // namespace

ShapiroWilk shapiroWilk(std::vector<double> samples) {
  ShapiroWilk result;
  for (const double sample : samples) {
    if (!std::isfinite(sample)) {
      result.reason = "a value is not finite";
      return result;
    }
  }
  std::sort(samples.begin(), samples.end());
  result.reason = reasonAgainst(samples);
  if (!result.reason.empty()) return result;
  result.w = statistic(samples);
  result.p = pValue(*result.w, samples.size());
  return result;
}

namespace {

/// Every k-th sample, k the smallest that leaves no more than the test allows.
std::vector<double> thinned(const std::pmr::vector<double>& samples, std::size_t& every) {
  every = (samples.size() + kShapiroWilkMost - 1) / kShapiroWilkMost;
  std::vector<double> kept;
  for (std::size_t i = 0; i < samples.size(); i += every) kept.push_back(samples[i]);
  return kept;
}

}  // namespace

NormalityMeasures normalityMeasures(const std::pmr::vector<double>& samples,
                                    const char* reason_when_empty) {
  NormalityMeasures measures;
  if (samples.empty()) {
    measures.w.reason = measures.p.reason = reason_when_empty;
    return measures;
  }
  std::size_t every = 1;
  const std::vector<double> used = thinned(samples, every);
  const ShapiroWilk test = shapiroWilk(used);
  Measure common;
  common.n = used.size();
  common.reason = test.reason;
  if (test.w && every > 1) {
    common.reason = "1 in " + std::to_string(every) + " of " + std::to_string(samples.size()) +
                    " samples taken";
  }
  measures.w = measures.p = common;
  measures.w.value = test.w;
  measures.p.value = test.p;
  return measures;
}

namespace {

bool isUsable(const SortedSamples& samples) { return !samples.empty() && samples.allFinite(); }

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

double meanDistance(const std::pmr::vector<double>& samples, double place) {
  double sum = 0.0;
  for (const double sample : samples) sum += std::abs(sample - place);
  return sum / static_cast<double>(samples.size());
}

}  // namespace

std::optional<double> wassersteinDistance(const SortedSamples& first_samples,
                                          const SortedSamples& second_samples) {
  if (!isUsable(first_samples) || !isUsable(second_samples)) return std::nullopt;
  const std::pmr::vector<double>& first = first_samples.sorted();
  const std::pmr::vector<double>& second = second_samples.sorted();
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

std::optional<double> wassersteinDistanceToNormal(const SortedSamples& samples, double mean,
                                                  double standard_deviation) {
  if (!isUsable(samples) || !std::isfinite(mean) || !std::isfinite(standard_deviation) ||
      standard_deviation < 0.0) {
    return std::nullopt;
  }
  const std::pmr::vector<double>& sorted = samples.sorted();
  if (standard_deviation == 0.0) return meanDistance(sorted, mean);
  const auto normed = [&](double sample) { return (sample - mean) / standard_deviation; };
  // Left of all samples the distance is Phi, right of them 1 - Phi(z) = Phi(-z).
  double distance =
      distributionIntegral(normed(sorted.front())) + distributionIntegral(-normed(sorted.back()));
  const double count = static_cast<double>(sorted.size());
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    distance += differenceIntegral(static_cast<double>(i) / count, normed(sorted[i - 1]),
                                   normed(sorted[i]));
  }
  return standard_deviation * distance;
}

}  // namespace cdiff::metrics
