// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/quantiles.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace cdiff::metrics {

namespace {

template <class Values>
double quantile(const Values& sorted, double share, QuantileRule rule) {
  const auto n = static_cast<double>(sorted.size());
  if (rule == QuantileRule::kNearestRank)
    return sorted[static_cast<std::size_t>(std::clamp(std::ceil(share * n), 1.0, n)) - 1];
  const double place = share * (n - 1.0);
  if (rule == QuantileRule::kNearestToLinear)
    return sorted[static_cast<std::size_t>(std::lround(place))];
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - std::floor(place)) * (sorted[above] - sorted[below]);
}

}  // namespace

double quantileOf(const std::vector<double>& sorted, double share, QuantileRule rule) {
  return quantile(sorted, share, rule);
}

double sampleQuantileOf(const std::pmr::vector<double>& sorted, double share, QuantileRule rule) {
  return quantile(sorted, share, rule);
}

double expandedTail(std::size_t clusters) {
  const auto m = static_cast<double>(clusters);
  const double t = boost::math::quantile(boost::math::students_t(m - 1.0), 0.975);
  return boost::math::cdf(boost::math::normal(), -std::sqrt(m / (m - 1.0)) * t);
}

}  // namespace cdiff::metrics
