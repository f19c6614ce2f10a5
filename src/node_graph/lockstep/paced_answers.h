// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/planning/planner.h"
#include "node_graph/lockstep/tick_answers.h"

namespace cdiff::node_graph {

// What drives when an answer is late (real_time_factor > 0).

/// What moves a vehicle at a tick.
struct AppliedAction {
  planning::PlannedAction planned;
  std::uint8_t driven_by = 0;   ///< as in DecidedVehicle
  std::uint64_t plan_tick = 0;  ///< tick of the decision whose plan it comes from
};

/// The actions alone.
std::vector<planning::PlannedAction> actionsOf(const std::vector<AppliedAction>& applied);

/// Which actions move the world when wall-clock time rules (real_time_factor > 0): those of each
/// vehicle's newest plan; while the next is late, that plan's next actions, and full braking once
/// it is 0.5 s old. A vehicle is taken over when its first action has arrived.
class PacedAnswers {
 public:
  /// `simulation_step` in [s].
  explicit PacedAnswers(double simulation_step, std::uint64_t ticks_per_decision = 2)
      : simulation_step_(simulation_step), ticks_per_decision_(ticks_per_decision) {}

  /// What the world is to take over and release at a tick: all that selections said since the last
  /// call, but no vehicle whose first action has not come; nullopt when nothing changes.
  std::optional<::e2e_cdiff::CbvSelection> selection(const ::e2e_cdiff::TrafficSnapshot& snapshot,
                                                     const TickAnswers& answers);
  /// Actions for the ego, the CBVs of a snapshot and those that are `taken` over now; ego first,
  /// then by slot.
  std::vector<AppliedAction> actions(const ::e2e_cdiff::TrafficSnapshot& snapshot,
                                     const std::optional<::e2e_cdiff::CbvSelection>& taken,
                                     const TickAnswers& answers) const;

 private:
  AppliedAction actionFor(int slot, const std::string& vehicle_id,
                          const ::e2e_cdiff::TrafficSnapshot& snapshot,
                          const TickAnswers& answers) const;
  bool fresh(const TickAnswers::TimedControl& control, std::uint64_t tick) const;

  double simulation_step_;
  std::uint64_t ticks_per_decision_;
  TickAnswers::Selection newest_;  ///< that has arrived
};

}  // namespace cdiff::node_graph
