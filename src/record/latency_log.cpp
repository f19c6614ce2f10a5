// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/latency_log.h"

#include <algorithm>
#include <cmath>

namespace cdiff::record {

double nearestRank(const std::vector<double>& sorted, double percent) {
  const double count = static_cast<double>(sorted.size());
  const double rank = std::clamp(std::ceil(percent / 100.0 * count), 1.0, count);
  return sorted[static_cast<std::size_t>(rank) - 1];
}

void LatencyLog::observe(const std::vector<session::PlannerLatency>& latencies) {
  for (const session::PlannerLatency& latency : latencies) {
    samples_[latency.planner].push_back(latency.milliseconds);
  }
}

std::map<std::string, LatencyFigures> LatencyLog::figures() const {
  std::map<std::string, LatencyFigures> figures;
  for (const auto& [planner, samples] : samples_) {
    std::vector<double> sorted = samples;
    std::sort(sorted.begin(), sorted.end());
    figures[planner] = {nearestRank(sorted, 50.0), nearestRank(sorted, 95.0), sorted.back(),
                        sorted.size()};
  }
  return figures;
}

}  // namespace cdiff::record
