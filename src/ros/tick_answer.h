// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What a planner answers for one vehicle at one decision.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/planning/planner.h"
#include "session/session_observer.h"

namespace cdiff::ros {

struct Answer {
  planning::PlannedAction action;
  std::string planner;                        ///< "ego:NAME" or "cbv:NAME"
  double latency_ms = 0.0;                    ///< wall time of the planning call [ms]
  std::string fault;                          ///< empty when none
  bool drove = true;                          ///< false where it came too late to drive
  std::optional<traffic::CameraImage> image;  ///< what the vehicle saw, where it came
};

/// The actions of answers that drove.
std::vector<planning::PlannedAction> actionsOf(const std::vector<Answer>& answers);
/// One latency per planning call: all CBVs share theirs. Planners that report none have none.
std::vector<session::PlannerLatency> latenciesOf(const std::vector<Answer>& answers);
/// What the vehicles saw, in the order of the answers.
std::vector<session::SlotImage> imagesOf(const std::vector<Answer>& answers);

}  // namespace cdiff::ros
