// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::session {

/// Wall time that a planner took for one decision.
struct PlannerLatency {
  std::string planner;  ///< "ego:pdm_lite", "cbv:pdm_lite"
  double milliseconds = 0.0;
};

/// How the answer to a decision fared in a session that goes on without one that is late: the
/// action of one vehicle, or the selection.
struct AnswerTiming {
  /// What drove the vehicle at the decision's tick in place of an answer that was not there.
  enum class Instead { kNothing, kPlan, kFullBrake, kNotDriven };

  std::string planner;    ///< "ego:pdm_lite", "cbv:diffusion", "cbv_identification"
  bool came = true;       ///< whether it came at all
  double lateness = 0.0;  ///< wall time from the end of its tick until it came [s]; 0 in time
  Instead instead = Instead::kNothing;

  bool punctual() const { return came && lateness <= 0.0; }
};

/// What the vehicle of a slot saw at a decision.
struct SlotImage {
  int slot = traffic::kEgoSlot;
  traffic::CameraImage image;
};

/// One tick. Selection, actions and latencies are there at decision ticks only. Where late answers
/// are replaced, they are those of the decision, whenever they came: actions that drove, latencies
/// of all.
struct TickRecord {
  const traffic::TrafficSnapshot* snapshot = nullptr;
  const cbv::CbvSelection* selection = nullptr;                   ///< nullptr between decisions
  const std::vector<planning::PlannedAction>* actions = nullptr;  ///< ego first, then CBVs by slot
  const std::vector<SlotImage>* images = nullptr;  ///< images of vehicles whose planner sees
  std::vector<PlannerLatency> latencies;           ///< latencies of planners that report theirs
  std::vector<AnswerTiming> timings;               ///< empty in sessions that wait for every answer
};

/// What a session shows to everything that records or measures it, tick by tick; the same whether
/// one process or the node graph drives.
class SessionObserver {
 public:
  virtual ~SessionObserver() = default;
  /// Called once per tick in order; the last snapshot has a final status.
  virtual void observe(const TickRecord& record) = 0;
};

}  // namespace cdiff::session
