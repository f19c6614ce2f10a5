// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
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

/// What the runs of one route add to a figure, which is sum / weight over all routes: weight 1 and
/// the value for a mean, km and events for a rate, samples for a share.
struct RouteSum {
  double sum = 0.0;
  double weight = 0.0;
};

/// By route, in a fixed order.
using RouteSums = std::vector<RouteSum>;

/// Sum of sums / sum of weights; nullopt where no weight is.
std::optional<double> pooledValue(const RouteSums& routes);

/// Bootstrap that draws whole routes with all their runs, since runs of one route are alike. The
/// interval is the *expanded percentile* interval: of kReplicates replicates the quantiles at a and
/// 1 - a with a = metrics::expandedTail of m routes, which widens the plain percentile interval as
/// Student's t does for few routes, and never leaves the range of the values. The draws are a
/// function of the replicate and m alone.
class RouteBootstrap {
 public:
  static constexpr std::size_t kReplicates = 10000;

  /// nullopt below two routes, and where all replicates are equal (routes that are all alike say
  /// nothing of their spread).
  std::optional<Interval> valueInterval(const RouteSums& routes);
  /// Of pooledValue(b) - pooledValue(a); each replicate takes the same routes on both sides.
  std::optional<Interval> differenceInterval(const RouteSums& a, const RouteSums& b);

  /// What the drawn routes give, by their indices from `first` on, as many as there are routes.
  using Replicate = std::function<std::optional<double>(const std::uint32_t* first)>;
  /// Of any other figure.
  std::optional<Interval> interval(std::size_t routes, const Replicate& replicate);

 private:
  const std::vector<std::uint32_t>& draws(std::size_t routes);

  std::map<std::size_t, std::vector<std::uint32_t>> draws_;  ///< by number of routes
};

/// Two-sided p of a difference between A and B on the same routes: the share of all ways to
/// exchange A and B on each route (all 2^m up to 14 routes, else 19,999 drawn ones and the observed
/// one) whose difference is at least as large (Fisher's randomization test by routes).
double exchangeTest(const RouteSums& a, const RouteSums& b);

/// The smallest p that exchangeTest can give on so many routes.
double leastExchangeP(std::size_t routes);

}  // namespace cdiff::evaluation
