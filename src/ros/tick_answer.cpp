// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/tick_answer.h"

#include <cmath>

namespace cdiff::ros {

std::vector<planning::PlannedAction> actionsOf(const std::vector<Answer>& answers) {
  std::vector<planning::PlannedAction> actions;
  for (const Answer& answer : answers) {
    if (answer.drove) actions.push_back(answer.action);
  }
  return actions;
}

std::vector<session::PlannerLatency> latenciesOf(const std::vector<Answer>& answers) {
  std::vector<session::PlannerLatency> latencies;
  for (const Answer& answer : answers) {
    if (!std::isfinite(answer.latency_ms) || answer.latency_ms <= 0.0) continue;
    const bool same_call = !latencies.empty() && latencies.back().planner == answer.planner;
    if (!same_call) latencies.push_back({answer.planner, answer.latency_ms});
  }
  return latencies;
}

std::vector<session::SlotImage> imagesOf(const std::vector<Answer>& answers) {
  std::vector<session::SlotImage> images;
  for (const Answer& answer : answers) {
    if (answer.image) images.push_back({answer.action.slot, *answer.image});
  }
  return images;
}

}  // namespace cdiff::ros
