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

/// When the answer to one decision arrived in a session that does not wait for late answers
/// (real_time_factor > 0), and what stood in for it. The answer is the action of one vehicle, or
/// the selection of CBV identification.
struct AnswerTiming {
  /// What drove the vehicle at the decision's tick in place of an answer that had not arrived:
  /// nothing was needed, the last plan's next action, full braking, or not yet taken over.
  enum class Instead { kNothing, kPlan, kFullBrake, kNotDriven };

  std::string planner;    ///< "ego:pdm_lite", "cbv:diffusion", "cbv_identification"
  bool came = true;       ///< whether it arrived at all
  double lateness = 0.0;  ///< wall time from the end of its tick to its arrival [s]; 0: in time
  Instead instead = Instead::kNothing;

  bool punctual() const { return came && lateness <= 0.0; }
};

/// The image of one camera that a vehicle's planner was given at a decision.
struct SlotImage {
  int slot = traffic::kEgoSlot;  ///< slot of a CBV; kEgoSlot for the ego
  traffic::CameraImage image;
  std::string camera = rendering::kFrontCamera;  ///< its name in the vehicle's rig
};

/// Everything that observers are given of one tick; the pointers hold during the call alone.
/// Selection, actions, images and latencies are set at decision ticks only. Where late answers are
/// replaced, `actions` holds the answers that drove a vehicle, however late, and `latencies` those
/// of all answers.
struct TickRecord {
  const traffic::TrafficSnapshot* snapshot = nullptr;
  const cbv::CbvSelection* selection = nullptr;                   ///< nullptr between decisions
  const std::vector<planning::PlannedAction>* actions = nullptr;  ///< ego first, then CBVs by slot
  const std::vector<SlotImage>* images = nullptr;  ///< of vehicles whose planner uses images:
                                                   ///< all cameras of a rig, in its order
  std::vector<PlannerLatency> latencies;           ///< of planners that report theirs
  std::vector<AnswerTiming> timings;               ///< empty in sessions that wait for every answer
};

/// Interface of everything that records or measures a session (metrics, result writer, video,
/// progress line). session::ClosedLoop calls it in one process, the observer nodes and the replay
/// of a bag elsewhere, with the same content.
class SessionObserver {
 public:
  virtual ~SessionObserver() = default;
  /// Called once per tick in order; the last snapshot has a final status.
  virtual void observe(const TickRecord& record) = 0;
};

}  // namespace cdiff::session
