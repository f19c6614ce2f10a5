// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/paced_answers.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/DecidedVehicle.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {
namespace {

constexpr double kOldest = 0.5;     // [s] a plan drives for less than this
constexpr double kRounding = 1e-6;  // [s], or rows of a plan; times are multiples of the step

bool drivenIn(const msgs::TrafficSnapshot& snapshot, const std::string& vehicle_id) {
  return std::any_of(snapshot.vehicles.begin(), snapshot.vehicles.end(), [&](const auto& vehicle) {
    return vehicle.id == vehicle_id && vehicle.role != msgs::Vehicle::BACKGROUND;
  });
}

/// The action that a plan holds for `age` [s] after its decision: that of its row at this age. A
/// plan whose first row is not the action itself (a tracker follows the plan) contains no later
/// actions, so the first one is held.
traffic::ControlAction actionAt(const msgs::ControlAction& first, const TickAnswers::Rollout& plan,
                                double age) {
  const traffic::ControlAction held = fromMsg(first).action;
  if (!plan || plan->points.empty()) return held;
  const auto row = static_cast<std::size_t>(std::floor(age / traffic::kRolloutStep + kRounding));
  const auto actionOf = [&](std::size_t index) {
    const msgs::RolloutPoint& point = plan->points[index];
    return traffic::ControlAction{point.throttle, point.steer, point.brake};
  };
  return row < plan->points.size() && actionOf(0) == held ? actionOf(row) : held;
}

}  // namespace

std::vector<planning::PlannedAction> actionsOf(const std::vector<AppliedAction>& applied) {
  std::vector<planning::PlannedAction> actions;
  for (const AppliedAction& action : applied) actions.push_back(action.planned);
  return actions;
}

bool PacedAnswers::fresh(const TickAnswers::TimedControl& control, std::uint64_t tick) const {
  const double age = static_cast<double>(tick - control.tick) * simulation_step_;
  return control.control && age < kOldest - kRounding;
}

std::optional<msgs::CbvSelection> PacedAnswers::selection(const msgs::TrafficSnapshot& snapshot,
                                                          const TickAnswers& answers) {
  msgs::CbvSelection merged;
  bool changed = false;
  while (const auto next =
             newest_ ? answers.selectionAfter(newest_->tick) : answers.firstSelection()) {
    newest_ = next;
    changed = true;
    merged.released.insert(merged.released.end(), next->released.begin(), next->released.end());
  }
  if (!newest_) return std::nullopt;
  merged.header = newest_->header;
  merged.tick = newest_->tick;
  for (const msgs::CbvAssignment& assignment : newest_->assignments) {
    const bool driven = drivenIn(snapshot, assignment.vehicle_id);
    const bool answered =
        fresh(answers.newest(assignment.slot, assignment.vehicle_id, snapshot.tick), snapshot.tick);
    if (!driven && !answered) continue;
    merged.assignments.push_back(assignment);
    changed = changed || !driven;
  }
  if (!changed) return std::nullopt;
  return merged;
}

AppliedAction PacedAnswers::actionFor(int slot, const std::string& vehicle_id,
                                      const msgs::TrafficSnapshot& snapshot,
                                      const TickAnswers& answers) const {
  const TickAnswers::TimedControl newest = answers.newest(slot, vehicle_id, snapshot.tick);
  AppliedAction applied;
  applied.planned.slot = slot;
  applied.planned.vehicle_id = vehicle_id;
  if (!fresh(newest, snapshot.tick)) {
    applied.planned.action = traffic::ControlAction::failSafe();
    applied.driven_by = msgs::DecidedVehicle::FULL_BRAKE;
    return applied;
  }
  const std::uint64_t decision = snapshot.tick - snapshot.tick % ticks_per_decision_;
  applied.plan_tick = newest.tick;
  applied.driven_by =
      newest.tick >= decision ? msgs::DecidedVehicle::ANSWER : msgs::DecidedVehicle::PLAN;
  applied.planned.action =
      actionAt(*newest.control, answers.rollout(slot, newest.tick),
               static_cast<double>(snapshot.tick - newest.tick) * simulation_step_);
  return applied;
}

std::vector<AppliedAction> PacedAnswers::actions(const msgs::TrafficSnapshot& snapshot,
                                                 const std::optional<msgs::CbvSelection>& taken,
                                                 const TickAnswers& answers) const {
  std::vector<AppliedAction> applied;
  for (const msgs::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == msgs::Vehicle::BACKGROUND) continue;
    const int slot = vehicle.role == msgs::Vehicle::CBV ? vehicle.cbv_slot : kEgoSlot;
    applied.push_back(actionFor(slot, vehicle.id, snapshot, answers));
  }
  if (!taken) return applied;
  for (const msgs::CbvAssignment& assignment : taken->assignments) {
    if (drivenIn(snapshot, assignment.vehicle_id)) continue;
    applied.push_back(actionFor(assignment.slot, assignment.vehicle_id, snapshot, answers));
  }
  std::stable_sort(applied.begin(), applied.end(),
                   [](const AppliedAction& left, const AppliedAction& right) {
                     return left.planned.slot < right.planned.slot;
                   });
  return applied;
}

}  // namespace cdiff::node_graph
