// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/rank_correlation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cdiff::metrics {
namespace {

/// Ranks from 1; equal values share their mean rank.
std::vector<double> ranksOf(const std::vector<double>& values) {
  std::vector<double> ranks;
  for (const double value : values) {
    const auto below =
        std::count_if(values.begin(), values.end(), [&](double other) { return other < value; });
    const auto equal = std::count(values.begin(), values.end(), value);
    ranks.push_back(static_cast<double>(below) + 0.5 * static_cast<double>(equal + 1));
  }
  return ranks;
}

}  // namespace

std::optional<double> rankCorrelation(const std::vector<double>& first,
                                      const std::vector<double>& second) {
  if (first.size() != second.size())
    throw std::invalid_argument("rank correlation: sides of different lengths");
  if (first.size() < 3) return std::nullopt;
  const std::vector<double> a = ranksOf(first);
  const std::vector<double> b = ranksOf(second);
  const double mean = 0.5 * static_cast<double>(a.size() + 1);
  double product = 0.0;
  double square_a = 0.0;
  double square_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    product += (a[i] - mean) * (b[i] - mean);
    square_a += (a[i] - mean) * (a[i] - mean);
    square_b += (b[i] - mean) * (b[i] - mean);
  }
  const double scale = std::sqrt(square_a * square_b);
  return scale > 0.0 ? std::optional(product / scale) : std::nullopt;
}

}  // namespace cdiff::metrics
