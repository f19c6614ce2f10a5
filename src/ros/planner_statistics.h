// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// How a planner fares over a session: latency [ms], batch size, age of images, faults by
/// kind, calls that took longer than the decision period. For /diagnostics.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "diagnostic_updater/diagnostic_updater.h"
#include "ros/image_inbox.h"

namespace cdiff::ros {

class PlannerStatistics {
 public:
  /// `decision_period` [s]: a call that takes longer in wall time misses its deadline.
  explicit PlannerStatistics(double decision_period = 0.1) : decision_period_(decision_period) {}

  void observe(const PlannerDecision& decision);
  /// Vehicles that got the fail-safe action, by kind: "image missing", "image refused", "planning
  /// call" (all of a call), "vehicle" (the planner's own).
  const std::map<std::string, std::uint64_t>& faults() const { return faults_; }
  std::uint64_t deadlineMisses() const { return deadline_misses_; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  double decision_period_;
  std::vector<double> latencies_ms_;
  std::map<std::string, std::uint64_t> faults_;
  std::uint64_t deadline_misses_ = 0;
  std::size_t batch_size_ = 0;  ///< vehicles in the last call
  double image_age_ = 0.0;      ///< of the last call [s]
};

}  // namespace cdiff::ros
