// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/intervals/exact_intervals.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <numeric>

namespace cdiff::evaluation {
namespace {

/// Odds of a probability; infinite at 1.
double odds(double probability) {
  return probability < 1.0 ? probability / (1.0 - probability)
                           : std::numeric_limits<double>::infinity();
}

/// Twice the smaller tail of a binomial distribution at `successes`.
double binomialP(std::size_t successes, std::size_t trials, double probability) {
  const auto x = static_cast<double>(successes);
  const auto n = static_cast<double>(trials);
  const double at_least = successes == 0 ? 1.0 : boost::math::ibeta(x, n - x + 1.0, probability);
  const double at_most =
      successes == trials ? 1.0 : boost::math::ibetac(x + 1.0, n - x, probability);
  return std::min(1.0, 2.0 * std::min(at_least, at_most));
}

}  // namespace

Interval poissonInterval(std::size_t events) {
  // The quantile of chi-square with 2 a degrees of freedom is twice that of the gamma distribution
  // of shape a.
  const auto x = static_cast<double>(events);
  return {events == 0 ? 0.0 : boost::math::gamma_p_inv(x, kTail),
          boost::math::gamma_q_inv(x + 1.0, kTail)};
}

Interval binomialInterval(std::size_t successes, std::size_t trials) {
  const auto x = static_cast<double>(successes);
  const auto n = static_cast<double>(trials);
  return {successes == 0 ? 0.0 : boost::math::ibeta_inv(x, n - x + 1.0, kTail),
          successes == trials ? 1.0 : boost::math::ibetac_inv(x + 1.0, n - x, kTail)};
}

double largestShareUnseen(std::size_t routes) {
  return 1.0 - std::pow(kTail, 1.0 / static_cast<double>(routes));
}

RateComparison compareRates(std::size_t events_a, double km_a, std::size_t events_b, double km_b) {
  const std::size_t events = events_a + events_b;
  RateComparison result;
  result.ratio = (static_cast<double>(events_b) / km_b) / (static_cast<double>(events_a) / km_a);
  result.interval = {0.0, std::numeric_limits<double>::infinity()};
  if (events == 0) return result;
  result.p = binomialP(events_b, events, km_b / (km_a + km_b));
  const Interval share = binomialInterval(events_b, events);
  result.interval = {odds(share.low) * km_a / km_b, odds(share.high) * km_a / km_b};
  return result;
}

std::vector<double> holmAdjusted(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t left, std::size_t right) { return p[left] < p[right]; });
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, static_cast<double>(p.size() - i) * p[order[i]]);
    adjusted[order[i]] = std::min(1.0, largest);
  }
  return adjusted;
}

}  // namespace cdiff::evaluation
