// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/decision_tracker.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>

#include "core/text.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"
#include "traffic/shown_fault.h"

namespace cdiff::node_graph {
namespace {

constexpr double kGiveUpAfter =
    10.0;  // [s] of simulated time until nothing more of a silent planner is awaited

/// A vehicle of a decision by slot and id.
using Key = std::pair<int, std::string>;

/// The vehicles that a decision asks for: the ego, and the CBVs of its selection that are there.
std::vector<Key> askedFor(const msgs::TrafficSnapshot& snapshot, const TickAnswers& answers) {
  std::vector<Key> keys;
  for (const msgs::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == msgs::Vehicle::EGO) keys.emplace_back(kEgoSlot, vehicle.id);
  }
  if (const auto selection = answers.selection(snapshot.tick)) {
    for (const msgs::CbvAssignment& assignment : selection->assignments) {
      if (contains(snapshot, assignment.vehicle_id))
        keys.emplace_back(assignment.slot, assignment.vehicle_id);
    }
  }
  return keys;
}

/// As the answer of another node would carry it: a user's own planner may leave fields out.
msgs::ControlAction completed(const msgs::ControlAction& control, const Key& key,
                              const msgs::TrafficSnapshot& snapshot) {
  msgs::ControlAction answer = control;
  answer.header.stamp = snapshot.header.stamp;
  answer.tick = snapshot.tick;
  answer.slot = key.first;
  answer.vehicle_id = key.second;
  answer.fault = traffic::shownFaultText(control.fault);
  answer.planner = traffic::shownSource(control.planner);
  if (answer.planner.empty())
    answer.planner = key.first == kEgoSlot ? "ego:external" : "cbv:external";
  return answer;
}

void setAction(msgs::DecidedVehicle& vehicle, const traffic::ControlAction& action) {
  vehicle.throttle = action.throttle;
  vehicle.steer = action.steer;
  vehicle.brake = action.brake;
}

msgs::DecisionRecord emptyRecord(const msgs::TrafficSnapshot& snapshot) {
  msgs::DecisionRecord record;
  record.header.stamp = snapshot.header.stamp;
  record.header.frame_id = frameId(kMapFrame);
  record.tick = snapshot.tick;
  return record;
}

std::string sentence(const std::string& subject, std::uint64_t tick, bool came, double lateness,
                     const std::string& instead) {
  const std::string begin = subject + " to tick " + std::to_string(tick);
  return (came ? begin + " came " + core::formatFixed(lateness, 3) + " s after its time"
               : begin + " never came") +
         "; " + instead + "; further late answers are counted in late_answers";
}

std::string insteadText(const msgs::DecidedVehicle& vehicle) {
  const std::string whom = "vehicle '" + vehicle.vehicle_id + "' ";
  const std::string action = "throttle " + core::formatNumber(vehicle.throttle) + ", steer " +
                             core::formatNumber(vehicle.steer) + ", brake " +
                             core::formatNumber(vehicle.brake);
  if (vehicle.driven_by == msgs::DecidedVehicle::SIMULATOR) return whom + "was not taken over yet";
  if (vehicle.driven_by == msgs::DecidedVehicle::FULL_BRAKE)
    return whom + "braked fully, as no plan of the last 0.5 s was there";
  return whom + "drove on by the plan of tick " + std::to_string(vehicle.plan_tick) + " (" +
         action + ")";
}

}  // namespace

DecisionTracker::DecisionTracker(const session::ScenarioOptions& options)
    : ego_planner_("ego:" + options.ego_planner),
      cbv_planner_("cbv:" + options.cbv_planner),
      ticks_per_decision_(static_cast<std::uint64_t>(
          std::llround(options.decision_period / options.simulation_step))),
      give_up_after_(
          static_cast<std::uint64_t>(std::llround(kGiveUpAfter / options.simulation_step))) {}

void DecisionTracker::ended(std::uint64_t tick, const std::vector<AppliedAction>& applied,
                            double now) {
  for (const AppliedAction& action : applied) {
    if (action.driven_by != msgs::DecidedVehicle::FULL_BRAKE)
      drove_.emplace(action.plan_tick, action.planned.slot);
  }
  if (open_.empty() || open_.back().snapshot->tick != tick) return;
  open_.back().ended_at = now;
  open_.back().applied = applied;
}

/// Whether nothing more is awaited: it came, or its planner has answered a later decision, or it
/// has been silent for long.
bool DecisionTracker::settled(const Decision& decision, const TickAnswers& answers,
                              std::uint64_t tick) const {
  const msgs::TrafficSnapshot& snapshot = *decision.snapshot;
  if (!decision.ended_at) return false;
  if (tick - snapshot.tick > give_up_after_) return true;
  const std::uint64_t next = snapshot.tick + ticks_per_decision_;
  if (!answers.selection(snapshot.tick) && !answers.selectionAfter(snapshot.tick)) return false;
  for (const auto& [slot, vehicle_id] : askedFor(snapshot, answers)) {
    const bool came = answers.within(slot, snapshot.tick, next).control != nullptr;
    if (!came && !answers.answeredFrom(slot, next)) return false;
  }
  return true;
}

double DecisionTracker::lateness(const Decision& decision, int slot, std::uint64_t tick) const {
  const auto arrival = arrivals_.find({tick, slot});
  if (arrival == arrivals_.end() || !decision.ended_at) return 0.0;
  return std::max(0.0, arrival->second - *decision.ended_at);
}

void DecisionTracker::fill(msgs::DecidedVehicle& vehicle, const Decision& decision,
                           const TickAnswers& answers) const {
  const msgs::TrafficSnapshot& snapshot = *decision.snapshot;
  const bool ego = vehicle.slot == kEgoSlot;
  const TickAnswers::TimedControl answer =
      answers.within(vehicle.slot, snapshot.tick, snapshot.tick + ticks_per_decision_);
  vehicle.answer.planner = ego ? ego_planner_ : cbv_planner_;
  vehicle.answered = answer.control && (ego || answer.control->vehicle_id == vehicle.vehicle_id);
  if (!vehicle.answered) return;
  vehicle.answer = completed(*answer.control, {vehicle.slot, vehicle.vehicle_id}, snapshot);
  vehicle.lateness = lateness(decision, vehicle.slot, answer.tick);
  vehicle.answer_drove = drove_.count({answer.tick, vehicle.slot}) > 0;
}

msgs::DecisionRecord DecisionTracker::recordOf(const Decision& decision,
                                               const TickAnswers& answers) const {
  const msgs::TrafficSnapshot& snapshot = *decision.snapshot;
  msgs::DecisionRecord record = emptyRecord(snapshot);
  record.selection_came = answers.selection(snapshot.tick) != nullptr;
  record.selection_lateness = lateness(decision, kSelection, snapshot.tick);
  std::map<Key, msgs::DecidedVehicle> vehicles;
  for (const AppliedAction& applied : decision.applied) {
    msgs::DecidedVehicle& vehicle = vehicles[{applied.planned.slot, applied.planned.vehicle_id}];
    vehicle.driven_by = applied.driven_by;
    vehicle.plan_tick = applied.plan_tick;
    setAction(vehicle, applied.planned.action);
  }
  for (const Key& key : askedFor(snapshot, answers)) {
    const auto [entry, added] = vehicles.try_emplace(key);
    entry->second.asked = true;
    if (added) entry->second.driven_by = msgs::DecidedVehicle::SIMULATOR;
  }
  for (auto& [key, vehicle] : vehicles) {
    vehicle.slot = key.first;
    vehicle.vehicle_id = key.second;
    if (vehicle.asked) fill(vehicle, decision, answers);
    record.vehicles.push_back(vehicle);
  }
  return record;
}

void DecisionTracker::count(const msgs::DecisionRecord& record) {
  late_ += !record.selection_came || record.selection_lateness > 0.0;
  for (const msgs::DecidedVehicle& vehicle : record.vehicles)
    late_ += vehicle.asked && (!vehicle.answered || vehicle.lateness > 0.0);
}

std::vector<msgs::DecisionRecord::ConstPtr> DecisionTracker::settle(const TickAnswers& answers,
                                                                    std::uint64_t tick, bool all) {
  std::vector<msgs::DecisionRecord::ConstPtr> records;
  while (!open_.empty() && (all || settled(open_.front(), answers, tick))) {
    records.push_back(
        boost::make_shared<const msgs::DecisionRecord>(recordOf(open_.front(), answers)));
    if (open_.front().ended_at) count(*records.back());
    open_.pop_front();
  }
  forget();
  return records;
}

std::optional<std::uint64_t> DecisionTracker::oldestOpen() const {
  if (open_.empty()) return std::nullopt;
  return open_.front().snapshot->tick;
}

/// What belongs to decisions that are settled.
void DecisionTracker::forget() {
  if (open_.empty()) return;
  const std::pair<std::uint64_t, int> oldest(open_.front().snapshot->tick, kSelection);
  arrivals_.erase(arrivals_.begin(), arrivals_.lower_bound(oldest));
  drove_.erase(drove_.begin(), drove_.lower_bound(oldest));
}

msgs::DecisionRecord punctualRecord(const msgs::TrafficSnapshot& snapshot,
                                    const TickAnswers& answers) {
  msgs::DecisionRecord record = emptyRecord(snapshot);
  record.selection_came = answers.selection(snapshot.tick) != nullptr;
  for (const Key& key : askedFor(snapshot, answers)) {
    const auto control = answers.control(key.first, snapshot.tick);
    if (!control) continue;
    msgs::DecidedVehicle vehicle;
    vehicle.slot = key.first;
    vehicle.vehicle_id = key.second;
    vehicle.driven_by = msgs::DecidedVehicle::ANSWER;
    vehicle.plan_tick = snapshot.tick;
    vehicle.asked = vehicle.answered = vehicle.answer_drove = true;
    vehicle.answer = completed(*control, key, snapshot);
    setAction(vehicle, fromMsg(vehicle.answer).action);
    record.vehicles.push_back(vehicle);
  }
  return record;
}

std::map<LatePlanner, std::string> latenessTexts(const msgs::DecisionRecord& record) {
  std::map<LatePlanner, std::string> texts;
  if (!record.selection_came || record.selection_lateness > 0.0) {
    texts[{kCbvIdentificationNode}] = sentence("the selection", record.tick, record.selection_came,
                                               record.selection_lateness, "the earlier one stayed");
  }
  for (const msgs::DecidedVehicle& vehicle : record.vehicles) {
    if (!vehicle.asked || (vehicle.answered && vehicle.lateness <= 0.0)) continue;
    const bool full_brake = vehicle.driven_by == msgs::DecidedVehicle::FULL_BRAKE;
    texts.try_emplace({vehicle.answer.planner, full_brake},
                      sentence("the answer", record.tick, vehicle.answered, vehicle.lateness,
                               insteadText(vehicle)));
  }
  return texts;
}

}  // namespace cdiff::node_graph
