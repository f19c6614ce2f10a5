// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <vector>

namespace cdiff::evaluation {

/// A 95 % interval.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Probability left out at each end of an interval.
inline constexpr double kTail = 0.025;

/// Expected number of events after `events` of a Poisson process (Garwood 1936): half the
/// chi-square quantiles chi2(0.025; 2 x) / 2 and chi2(0.975; 2 x + 2) / 2. No event: 0 to -ln 0.025
/// = 3.689.
Interval poissonInterval(std::size_t events);

/// Probability of a success after `successes` of `trials` (Clopper and Pearson 1934), by quantiles
/// of the beta distribution. `trials` must be positive.
Interval binomialInterval(std::size_t successes, std::size_t trials);

/// The largest share of routes that would still leave `routes` drawn ones alike with probability
/// 0.025: 1 - 0.025^(1 / routes), about 3.7 / routes ("rule of three" at two-sided 95 %).
double largestShareUnseen(std::size_t routes);

/// Two counts over the distances driven for them.
struct RateComparison {
  double p = 1.0;      ///< two-sided: twice the smaller tail, at most 1
  double ratio = 0.0;  ///< rate of B / rate of A; infinite or NaN where A has no event
  Interval interval;   ///< of the ratio; `high` may be infinite
};

/// Exact conditional test: given both counts' sum n, that of B is binomial with probability
/// km_b / (km_a + km_b) where the rates are equal (Przyborowski and Wilenski 1940); the ratio's
/// interval is that of Clopper and Pearson. Distances must be positive.
RateComparison compareRates(std::size_t events_a, double km_a, std::size_t events_b, double km_b);

/// p adjusted for their number by Holm's step-down method (1979), in the same order: those at 0.05
/// or below are significant with a probability of at most 5 % of any false one among all.
std::vector<double> holmAdjusted(const std::vector<double>& p);

}  // namespace cdiff::evaluation
