// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Wall time that each planner took per decision [ms]: median, 95th percentile (nearest rank) and
/// maximum.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "session/session_observer.h"

namespace cdiff::record {

struct LatencyFigures {
  double median = 0.0;         ///< [ms]
  double percentile_95 = 0.0;  ///< [ms]
  double maximum = 0.0;        ///< [ms]
  std::size_t n = 0;           ///< decisions
};

/// The smallest sample that at least `percent` of all are not above (nearest rank). `sorted`
/// ascends and is not empty.
double nearestRank(const std::vector<double>& sorted, double percent);

class LatencyLog {
 public:
  void observe(const std::vector<session::PlannerLatency>& latencies);
  /// By planner name.
  std::map<std::string, LatencyFigures> figures() const;

 private:
  std::map<std::string, std::vector<double>> samples_;
};

}  // namespace cdiff::record
