// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Collects what the other nodes answer to a tick (selection and controls; where expected guidance,
/// rollouts and images), whatever the order of arrival, and says what is still missing. The traffic
/// simulator, the metrics and the recorder wait by the same rule.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/DecisionRecord.h"
#include "e2e_cdiff/GuidanceReport.h"
#include "e2e_cdiff/Rollout.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/planning/planner.h"
#include "ros/image_inbox.h"
#include "session/session_observer.h"

namespace cdiff::ros {

/// A planner's answer for one vehicle.
struct Answer {
  planning::PlannedAction action;
  std::string planner;  ///< "ego:NAME" or "cbv:NAME"
  double latency_ms = 0.0;
  std::string fault;  ///< empty when none
  bool drove = true;  ///< false where it came too late to drive
};

/// The actions of answers that drove.
std::vector<planning::PlannedAction> actionsOf(const std::vector<Answer>& answers);
/// One latency per planning call: all CBVs share theirs. Planners that report none have none.
std::vector<session::PlannerLatency> latenciesOf(const std::vector<Answer>& answers);

/// What a decision needs besides selection and controls.
struct ExpectedAnswers {
  bool guidance = false;    ///< a report, where there is a CBV to drive
  bool rollouts = false;    ///< of every CBV
  bool ego_image = false;   ///< of the ego
  bool cbv_images = false;  ///< of every CBV
  bool record = false;      ///< the traffic simulator's record of it, which says what came
};

class TickAnswers {
 public:
  using Selection = ::e2e_cdiff::CbvSelection::ConstPtr;
  using Control = ::e2e_cdiff::ControlAction::ConstPtr;
  using Guidance = ::e2e_cdiff::GuidanceReport::ConstPtr;
  using Rollout = ::e2e_cdiff::Rollout::ConstPtr;
  using Image = sensor_msgs::Image::ConstPtr;
  using Decision = ::e2e_cdiff::DecisionRecord::ConstPtr;

  /// `simulation_step` [s] turns a stamp without tick into a tick; `camera` says what images must
  /// be like.
  explicit TickAnswers(double simulation_step = 0.05, const ExpectedAnswers& expected = {},
                       const rendering::CameraOptions& camera = {})
      : simulation_step_(simulation_step), expected_(expected), images_(camera, simulation_step) {}

  void add(const Selection& selection);
  void add(const Guidance& guidance);
  void addRollout(int slot, const Rollout& rollout);
  /// `slot`: kEgoSlot for the ego.
  void addImage(int slot, const Image& image) { images_.add(slot, image); }
  /// A control that carries a stamp but no tick counts for the tick of its stamp; one with neither
  /// for `otherwise`. Answers the tick that it counts for.
  std::uint64_t addEgo(const Control& control, std::uint64_t otherwise = 0);
  void addCbv(int slot, const Control& control);
  /// From now on the answers to this decision are those that the record names.
  void add(const Decision& record);

  /// What `snapshot` still needs: topic names. Once its decision's record is here, what that names.
  /// Empty at ticks without decision.
  std::vector<std::string> missing(const ::e2e_cdiff::TrafficSnapshot& snapshot) const;
  /// The answers to a tick; nullptr where there is none.
  Selection selection(std::uint64_t tick) const;
  Control ego(std::uint64_t tick) const;
  Control cbv(int slot, std::uint64_t tick) const;
  Guidance guidance(std::uint64_t tick) const;
  Decision decision(std::uint64_t tick) const;
  Rollout rollout(int slot, std::uint64_t tick) const;
  Image image(int slot, std::uint64_t tick) const { return images_.find(slot, tick); }
  /// What the vehicles that were answered for saw, in the order of their answers; an image that is
  /// not as it must be is left out.
  std::vector<session::SlotImage> images(const ::e2e_cdiff::TrafficSnapshot& snapshot) const;
  /// Answers of planners to a decision: the ego's, then those of assigned CBVs by slot; those that
  /// are missing are left out. With guidance and
  /// rollouts where they came.
  std::vector<Answer> answers(const ::e2e_cdiff::TrafficSnapshot& snapshot) const;
  /// A control and the tick that it answers.
  struct TimedControl {
    std::uint64_t tick = 0;
    Control control;
  };
  /// The newest control of a slot (-1: ego) for that vehicle, up to `tick`; without control when
  /// there is none.
  TimedControl newest(int slot, const std::string& vehicle_id, std::uint64_t tick) const;
  /// The first control of a slot for ticks from `begin` to before `end`.
  TimedControl within(int slot, std::uint64_t begin, std::uint64_t end) const;
  /// Whether the planner of a slot has answered for a tick from `begin` on; all CBVs share one.
  bool answeredFrom(int slot, std::uint64_t begin) const;
  /// The oldest selection of all, or after a tick; nullptr when there is none.
  Selection firstSelection() const;
  Selection selectionAfter(std::uint64_t tick) const;
  /// Drops everything older than a tick.
  void forgetBefore(std::uint64_t tick);

 private:
  void addGuidance(Answer& answer, std::uint64_t tick) const;
  void addTiming(Answer& answer, std::uint64_t tick) const;
  std::vector<std::string> missingOf(int slot, std::uint64_t tick) const;
  std::vector<std::string> missingOf(const ::e2e_cdiff::DecisionRecord& record) const;
  std::uint64_t tickOf(const ::e2e_cdiff::ControlAction& control, std::uint64_t otherwise) const;
  double simulation_step_;
  ExpectedAnswers expected_;
  ImageInbox images_;
  std::map<std::uint64_t, Decision> decisions_;
  std::map<std::uint64_t, Guidance> guidance_;
  std::map<std::uint64_t, Selection> selections_;
  std::map<std::uint64_t, std::map<int, Control>> controls_;  ///< by tick, then slot
  std::map<std::uint64_t, std::map<int, Rollout>> rollouts_;  ///< by tick, then slot
};

/// Whether a snapshot holds a vehicle.
bool contains(const ::e2e_cdiff::TrafficSnapshot& snapshot, const std::string& vehicle_id);

}  // namespace cdiff::ros
