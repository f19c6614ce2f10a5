// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/paced_answers.h"

#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/ros/conversions.h"

namespace cdiff::ros {
namespace {

constexpr double kOldest = 0.5;  // [s] of simulated time that an action may be held

}  // namespace

std::vector<planning::PlannedAction> PacedAnswers::actions(const msgs::TrafficSnapshot& snapshot,
                                                           const TickAnswers& answers) const {
  std::vector<planning::PlannedAction> actions;
  for (const msgs::Vehicle& vehicle : snapshot.vehicles) {
    const int slot = vehicle.role == msgs::Vehicle::CBV ? vehicle.cbv_slot : -1;
    if (vehicle.role == msgs::Vehicle::BACKGROUND) continue;
    const TickAnswers::TimedControl newest = answers.newest(slot, vehicle.id, snapshot.tick);
    if (!newest.control) continue;
    const double age = static_cast<double>(snapshot.tick - newest.tick) * simulation_step_;
    planning::PlannedAction action = fromMsg(*newest.control);
    action.vehicle_id = vehicle.id;
    action.slot = slot;
    if (age > kOldest) action.action = traffic::ControlAction::failSafe();
    actions.push_back(action);
  }
  return actions;
}

TickAnswers::Selection PacedAnswers::nextSelection(const TickAnswers& answers) {
  TickAnswers::Selection selection =
      any_selection_ ? answers.selectionAfter(last_selection_) : answers.selection(0);
  if (!selection && !any_selection_) selection = answers.selectionAfter(0);
  if (!selection) return nullptr;
  any_selection_ = true;
  last_selection_ = selection->tick;
  return selection;
}

std::string PacedAnswers::countLate(std::uint64_t tick,
                                    const std::vector<std::string>& missing_topics) {
  late_ += missing_topics.size();
  const bool begins = !missing_topics.empty() && !was_late_;
  was_late_ = !missing_topics.empty();
  if (!begins) return {};
  return "no answer in time for tick " + std::to_string(tick) + " on " +
         core::joinText(missing_topics, ", ") + "; the last action is held, full brake after 0.5 s";
}

}  // namespace cdiff::ros
