// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Collects what the other nodes answer to a tick (selection, controls, guidance), whatever the
/// order of arrival, and says what is still missing. The traffic simulator, the metrics and the
/// recorder wait by the same rule.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/GuidanceReport.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/scenario/session_observer.h"

namespace cdiff::ros {

/// A planner's answer for one vehicle.
struct Answer {
  planning::PlannedAction action;
  std::string planner;  ///< "ego:NAME" or "cbv:NAME"
  double latency_ms = 0.0;
  std::string fault;  ///< empty when none
};

/// The actions alone.
std::vector<planning::PlannedAction> actionsOf(const std::vector<Answer>& answers);
/// One latency per planning call: all CBVs share theirs.
std::vector<scenario::PlannerLatency> latenciesOf(const std::vector<Answer>& answers);

class TickAnswers {
 public:
  using Selection = ::e2e_cdiff::CbvSelection::ConstPtr;
  using Control = ::e2e_cdiff::ControlAction::ConstPtr;
  using Guidance = ::e2e_cdiff::GuidanceReport::ConstPtr;

  /// `simulation_step` [s] turns the stamp of a control without tick into a tick.
  explicit TickAnswers(double simulation_step = 0.05) : simulation_step_(simulation_step) {}

  /// From now on a tick with CBVs needs a guidance report too.
  void expectGuidance() { guidance_expected_ = true; }

  void add(const Selection& selection);
  void add(const Guidance& guidance);
  /// A control that carries a stamp but no tick counts for the tick of its stamp; one with neither
  /// for `otherwise`.
  void addEgo(const Control& control, std::uint64_t otherwise = 0);
  void addCbv(int slot, const Control& control);

  /// What `snapshot` still needs: topic names. Empty at ticks without decision.
  std::vector<std::string> missing(const ::e2e_cdiff::TrafficSnapshot& snapshot) const;
  /// The answers to a tick; nullptr where there is none.
  Selection selection(std::uint64_t tick) const;
  Control ego(std::uint64_t tick) const;
  Control cbv(int slot, std::uint64_t tick) const;
  Guidance guidance(std::uint64_t tick) const;
  /// Answers of planners to a decision: the ego's, then those of assigned CBVs by slot; those that
  /// are missing are left out. With guidance where a report came.
  std::vector<Answer> answers(const ::e2e_cdiff::TrafficSnapshot& snapshot) const;
  /// A control and the tick that it answers.
  struct TimedControl {
    std::uint64_t tick = 0;
    Control control;
  };
  /// The newest control of a slot (-1: ego) for that vehicle, up to `tick`; without control when
  /// there is none.
  TimedControl newest(int slot, const std::string& vehicle_id, std::uint64_t tick) const;
  /// The oldest selection after a tick; nullptr when there is none.
  Selection selectionAfter(std::uint64_t tick) const;
  /// Drops everything older than a tick.
  void forgetBefore(std::uint64_t tick);

 private:
  void addGuidance(Answer& answer, std::uint64_t tick) const;
  std::uint64_t tickOf(const ::e2e_cdiff::ControlAction& control, std::uint64_t otherwise) const;
  double simulation_step_;
  bool guidance_expected_ = false;
  std::map<std::uint64_t, Guidance> guidance_;
  std::map<std::uint64_t, Selection> selections_;
  std::map<std::uint64_t, std::map<int, Control>> controls_;  ///< by tick, then slot
};

/// Whether a snapshot holds a vehicle.
bool contains(const ::e2e_cdiff::TrafficSnapshot& snapshot, const std::string& vehicle_id);

}  // namespace cdiff::ros
