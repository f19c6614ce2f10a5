// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <memory_resource>
#include <vector>

namespace cdiff::metrics {

/// Definition of the quantile at a share p of n values in ascending order x_1 .. x_n (Hyndman and
/// Fan 1996, The American Statistician 50, 361-365).
enum class QuantileRule {
  kLinear,          ///< type 7, NumPy's default: x at 1 + p (n - 1), linear between neighbors
  kNearestRank,     ///< type 1: x at ceil(p n), so that at least the share p is not above it
  kNearestToLinear  ///< the x nearest to where kLinear interpolates
};

/// The quantile at `share` in [0, 1] of values in ascending order, at least one.
double quantileOf(const std::vector<double>& sorted, double share, QuantileRule rule);
/// The same of values in a session's memory.
double sampleQuantileOf(const std::pmr::vector<double>& sorted, double share, QuantileRule rule);

/// Share of replicates that the expanded percentile interval of 95 % leaves out at each end
/// (Hesterberg 2015, The American Statistician 69, 371-386, section 5.3):
/// Phi(-sqrt(m / (m - 1)) t(0.975; m - 1)) of m clusters, at least two.
double expandedTail(std::size_t clusters);

}  // namespace cdiff::metrics
