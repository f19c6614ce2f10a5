// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/planner_statistics.h"

#include <algorithm>

#include "core/text.h"
#include "record/latency_log.h"

namespace cdiff::ros {

void PlannerStatistics::observe(const PlannerDecision& decision) {
  const auto count = [this](const char* kind, std::size_t vehicles) {
    if (vehicles > 0) faults_[kind] += vehicles;
  };
  const auto unseeing = static_cast<std::size_t>(decision.missing + decision.refused);
  std::size_t fail_safe = 0;
  for (const planning::PlannedAction& action : decision.actions) fail_safe += !action.fault.empty();
  batch_size_ = decision.actions.size() - unseeing;
  image_age_ = decision.image_age;
  count("image missing", static_cast<std::size_t>(decision.missing));
  count("image refused", static_cast<std::size_t>(decision.refused));
  count("vehicle", fail_safe - unseeing);
  if (!decision.fault.empty()) count("planning call", batch_size_);
  if (batch_size_ == 0) return;
  latencies_ms_.push_back(decision.latency_ms);
  if (decision.latency_ms > 1000.0 * decision_period_) ++deadline_misses_;
}

void PlannerStatistics::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  std::uint64_t all = 0;
  for (const auto& [kind, vehicles] : faults_) {
    status.add("faults: " + kind, vehicles);
    all += vehicles;
  }
  status.summary(all == 0 ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
                 all == 0 ? "planning" : std::to_string(all) + " fail-safe actions");
  std::vector<double> sorted = latencies_ms_;
  std::sort(sorted.begin(), sorted.end());
  if (!sorted.empty()) {
    status.add("latency p50 [ms]", core::formatFixed(record::nearestRank(sorted, 50.0), 2));
    status.add("latency p95 [ms]", core::formatFixed(record::nearestRank(sorted, 95.0), 2));
  }
  status.add("decisions", latencies_ms_.size());
  status.add("deadline misses", deadline_misses_);
  status.add("batch size", batch_size_);
  status.add("image age [s]", core::formatFixed(image_age_, 3));
}

}  // namespace cdiff::ros
