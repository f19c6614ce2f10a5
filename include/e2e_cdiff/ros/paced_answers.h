// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Which actions move the world when wall-clock time rules (real_time_factor > 0): the newest of
/// each vehicle; held while the next is late, the fail-safe action once it is older than 0.5 s.
/// Counts what came late.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/ros/tick_answers.h"

namespace cdiff::ros {

class PacedAnswers {
 public:
  /// `simulation_step` in [s].
  explicit PacedAnswers(double simulation_step) : simulation_step_(simulation_step) {}

  /// Actions for the driven vehicles of a snapshot, ego first, then by slot.
  std::vector<planning::PlannedAction> actions(const ::e2e_cdiff::TrafficSnapshot& snapshot,
                                               const TickAnswers& answers) const;
  /// The oldest selection not yet given out; nullptr when there is none.
  TickAnswers::Selection nextSelection(const TickAnswers& answers);
  /// At each decision tick: counts the answers that it still lacks; a text for the record when
  /// lateness begins, else empty.
  std::string countLate(std::uint64_t tick, const std::vector<std::string>& missing_topics);
  std::uint64_t late() const { return late_; }

 private:
  double simulation_step_;
  bool any_selection_ = false;
  std::uint64_t last_selection_ = 0;  ///< tick
  bool was_late_ = false;
  std::uint64_t late_ = 0;
};

}  // namespace cdiff::ros
