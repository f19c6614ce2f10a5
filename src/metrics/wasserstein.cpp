// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/wasserstein.h"

#include <algorithm>
#include <cmath>

namespace cdiff::metrics {
namespace {

bool usable(const std::vector<double>& samples) {
  return !samples.empty() && std::all_of(samples.begin(), samples.end(),
                                         [](double sample) { return std::isfinite(sample); });
}

}  // namespace

std::optional<double> wassersteinDistance(std::vector<double> first, std::vector<double> second) {
  if (!usable(first) || !usable(second)) return std::nullopt;
  std::sort(first.begin(), first.end());
  std::sort(second.begin(), second.end());
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

}  // namespace cdiff::metrics
