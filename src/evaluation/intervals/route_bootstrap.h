// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "evaluation/intervals/exact_intervals.h"

namespace cdiff::evaluation {

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
/// interval is the *expanded percentile* interval (Hesterberg 2015, The American Statistician 69,
/// 371-386, section 5.3): of kReplicates replicates the quantiles at a and 1 - a with
/// a = Phi(-sqrt(m / (m - 1)) t(0.975; m - 1)) of m routes, which widens the plain percentile
/// interval as Student's t does for few routes, and never leaves the range of the values. The draws
/// are a function of the replicate and m alone.
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

}  // namespace cdiff::evaluation
