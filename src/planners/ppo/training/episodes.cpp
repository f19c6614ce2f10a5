// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/training/episodes.h"

#include <algorithm>
#include <cmath>

namespace cdiff::planners {
namespace {

constexpr const char* kGoalReached = "goal_reached";

/// Whom a vehicle touches at a tick.
struct Touch {
  bool ego = false;
  bool other = false;
};

Touch touchOf(const traffic::TrafficSnapshot& snapshot, const std::string& id) {
  Touch touch;
  for (const traffic::Contact& contact : snapshot.contacts) {
    if (contact.first != id && contact.second != id) continue;
    const std::string& partner = contact.first == id ? contact.second : contact.first;
    (partner == traffic::kEgoId ? touch.ego : touch.other) = true;
  }
  return touch;
}

bool assignedIn(const cbv::CbvSelection& selection, const std::string& id) {
  return std::any_of(
      selection.assignments.begin(), selection.assignments.end(),
      [&](const cbv::CbvAssignment& assignment) { return assignment.vehicle_id == id; });
}

}  // namespace

double PpoEpisode::total() const {
  double sum = 0.0;
  for (const PpoStep& step : steps) sum += step.reward;
  return sum;
}

PpoEpisodeLog::PpoEpisodeLog(const PpoPolicy& policy, const map::Route& ego_route)
    : policy_(policy), ego_route_(ego_route) {}

void PpoEpisodeLog::look(const traffic::TrafficSnapshot& snapshot) {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return;
  ego_.update(ego_route_, ego->state.position);
  goal_ = ppoGoal(ego_route_, ego_.arcLength());
  for (auto open = open_.begin(); open != open_.end();) {
    const Touch touch = touchOf(snapshot, open->first);
    const traffic::Vehicle* vehicle = snapshot.find(open->first);
    if (vehicle == nullptr || (!touch.ego && !touch.other)) {
      ++open;
      continue;
    }
    const double distance = ppoGoalDistance(goal_, vehicle->state);
    reward({open->second.distance, distance, touch.other, distance < kPpoGoalRadius}, open->second);
    open = close(open, touch.other ? PpoEnd::kOtherContact : PpoEnd::kEgoContact);
  }
}

void PpoEpisodeLog::reward(const PpoOutcome& outcome, Open& open) {
  if (!open.decided) return;
  open.pending.reward = ppoReward(outcome);
  open.episode.steps.push_back(open.pending);
  open.decided = false;
  ++steps_;
}

PpoEpisodeLog::Opens::iterator PpoEpisodeLog::close(Opens::iterator open, PpoEnd end) {
  open->second.episode.end = end;
  if (!open->second.episode.steps.empty()) ended_.push_back(std::move(open->second.episode));
  return open_.erase(open);
}

void PpoEpisodeLog::settle(const traffic::TrafficSnapshot& snapshot,
                           const cbv::CbvSelection& selection) {
  for (auto open = open_.begin(); open != open_.end();)
    open = settleOne(snapshot, assignedIn(selection, open->first), open);
}

PpoEpisodeLog::Opens::iterator PpoEpisodeLog::settleOne(const traffic::TrafficSnapshot& snapshot,
                                                        bool assigned, Opens::iterator open) {
  const traffic::Vehicle* vehicle = snapshot.find(open->first);
  if (vehicle == nullptr || snapshot.ego() == nullptr) {  // gone: its last step has no outcome
    open->second.episode.last = open->second.pending.observation;
    return close(open, PpoEnd::kCut);
  }
  const double distance = ppoGoalDistance(goal_, vehicle->state);
  const bool reached = distance < kPpoGoalRadius;
  reward({open->second.distance, distance, false, reached}, open->second);
  if (reached) {
    arrived_.insert(open->first);
    return close(open, PpoEnd::kGoal);
  }
  if (assigned) return std::next(open);
  open->second.episode.last = ppoObservation(snapshot, *snapshot.ego(), *vehicle, goal_);
  return close(open, PpoEnd::kCut);
}

PpoAction PpoEpisodeLog::decide(const std::string& id, std::uint64_t tick,
                                const PpoObservation& observation) const {
  if (!policy_.explores) return policy_.actor.act(observation);
  PpoAction action = policy_.actor.mean(observation);
  const core::RandomKey key{core::hashText(id), static_cast<std::uint32_t>(tick), 0};
  for (std::size_t i = 0; i < action.size(); ++i) {
    const double noise = policy_.noise.normal(key, static_cast<std::uint32_t>(i));
    action[i] += policy_.actor.deviation()[i] * static_cast<float>(noise);
  }
  return action;
}

planning::PlannedAction PpoEpisodeLog::act(const traffic::TrafficSnapshot& snapshot,
                                           const planning::PlanningTask& task) {
  const std::string& id = task.vehicle->id;
  planning::PlannedAction planned = planning::failSafeAction(task);
  if (snapshot.ego() == nullptr) return planned;
  Open& open = open_[id];
  open.pending.observation = ppoObservation(snapshot, *snapshot.ego(), *task.vehicle, goal_);
  if (!ppoNotFinite(open.pending.observation).empty()) {
    open_.erase(id);
    return planned;
  }
  open.pending.action = decide(id, snapshot.tick, open.pending.observation);
  open.distance = ppoGoalDistance(goal_, task.vehicle->state);
  open.decided = true;
  planned.action = ppoCommand(open.pending.action);
  return planned;
}

std::vector<PpoEpisode> PpoEpisodeLog::finish() {
  for (auto open = open_.begin(); open != open_.end();) {
    open->second.episode.last = open->second.pending.observation;
    open = close(open, PpoEnd::kCut);
  }
  return std::move(ended_);
}

void PpoEpisodeSelector::observe(const traffic::TrafficSnapshot& snapshot) {
  selector_->observe(snapshot);
  log_.look(snapshot);
}

cbv::CbvSelection PpoEpisodeSelector::update(const traffic::TrafficSnapshot& snapshot) {
  cbv::CbvSelection selection = selector_->update(snapshot);
  log_.look(snapshot);
  log_.settle(snapshot, selection);
  const auto drives_on = [&](const cbv::CbvAssignment& assignment) {
    if (!log_.arrived(assignment.vehicle_id)) return false;
    if (given_back_.insert(assignment.vehicle_id).second)
      selection.released.push_back({assignment.slot, assignment.vehicle_id, kGoalReached});
    return true;
  };
  auto& assignments = selection.assignments;
  assignments.erase(std::remove_if(assignments.begin(), assignments.end(), drives_on),
                    assignments.end());
  return selection;
}

std::vector<planning::PlannedAction> PpoEpisodePlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions;
  for (const planning::PlanningTask& task : tasks) actions.push_back(log_.act(snapshot, task));
  return actions;
}

}  // namespace cdiff::planners
