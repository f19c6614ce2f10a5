// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/messages/topics.h"

namespace cdiff::node_graph {

/// Nodes of the user's own in the place of the CBVs' planner, as the traffic simulator sees them:
/// which vehicle each command on cbv_K/control is for, and how long it took. A command counts for
/// the vehicle that the selection of its tick puts into the slot, once that selection is here. One
/// for another vehicle becomes full braking with a fault; one for an empty slot counts for nothing.
class ExternalCbvs {
 public:
  /// Takes a command that names planner, tick, slot and vehicle.
  using Give = std::function<void(const Topic& topic, const AnyMessage& control)>;

  /// `simulation_step` [s] turns a stamp into a tick. Where the wall clock rules (`paced`), a
  /// command with neither tick nor stamp answers the newest decision.
  ExternalCbvs(double simulation_step, bool paced, Give give);

  /// A tick is out.
  void published(const ::e2e_cdiff::TrafficSnapshot& snapshot);
  /// A selection has come.
  void selected(const ::e2e_cdiff::CbvSelection::ConstPtr& selection);
  /// Takes a command of a slot's topic; returns why it counts for nothing, empty when it counts.
  std::string take(const Topic& topic, const AnyMessage& message);

 private:
  using Clock = std::chrono::steady_clock;
  struct Command {
    ::e2e_cdiff::ControlAction::ConstPtr control;
    Clock::time_point came;
  };
  void address(const Topic& topic, const std::string& vehicle_id,
               ::e2e_cdiff::ControlAction& control) const;
  void give(const Topic& topic, const Command& command,
            const ::e2e_cdiff::CbvSelection& selection) const;

  double simulation_step_;  ///< [s]
  bool paced_;
  Give give_;
  std::uint64_t newest_ = 0;                                 ///< tick
  std::uint64_t decision_ = 0;                               ///< newest tick with a decision
  std::map<std::uint64_t, Clock::time_point> published_at_;  ///< of late decisions
  std::map<std::uint64_t, ::e2e_cdiff::CbvSelection::ConstPtr> selections_;  ///< of late ticks
  std::map<std::pair<std::uint64_t, Topic>, Command> early_;  ///< come before their selection
};

}  // namespace cdiff::node_graph
