// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/tick_answers.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "ros/conversions.h"
#include "ros/topics.h"

namespace cdiff::ros {
namespace {

const msgs::Vehicle* findEgo(const msgs::TrafficSnapshot& snapshot) {
  const auto found =
      std::find_if(snapshot.vehicles.begin(), snapshot.vehicles.end(),
                   [](const msgs::Vehicle& vehicle) { return vehicle.role == msgs::Vehicle::EGO; });
  return found == snapshot.vehicles.end() ? nullptr : &*found;
}

/// A user's own planner may leave out whom it drives and what it is called.
Answer answerOf(const msgs::ControlAction& control, int slot, const std::string& vehicle_id) {
  Answer answer;
  answer.action = fromMsg(control);
  answer.action.slot = slot;
  answer.action.vehicle_id = vehicle_id;
  answer.planner = control.planner.empty() ? "ego:external" : control.planner;
  answer.latency_ms = control.planner_latency_ms;
  answer.fault = control.fault;
  return answer;
}

template <class Message>
Message findIn(const std::map<std::uint64_t, std::map<int, Message>>& messages, int slot,
               std::uint64_t tick) {
  const auto at_tick = messages.find(tick);
  if (at_tick == messages.end()) return nullptr;
  const auto found = at_tick->second.find(slot);
  return found == at_tick->second.end() ? nullptr : found->second;
}

}  // namespace

std::vector<planning::PlannedAction> actionsOf(const std::vector<Answer>& answers) {
  std::vector<planning::PlannedAction> actions;
  for (const Answer& answer : answers) {
    if (answer.drove) actions.push_back(answer.action);
  }
  return actions;
}

std::vector<session::PlannerLatency> latenciesOf(const std::vector<Answer>& answers) {
  std::vector<session::PlannerLatency> latencies;
  for (const Answer& answer : answers) {
    if (!std::isfinite(answer.latency_ms) || answer.latency_ms <= 0.0) continue;
    const bool same_call = !latencies.empty() && latencies.back().planner == answer.planner;
    if (!same_call) latencies.push_back({answer.planner, answer.latency_ms});
  }
  return latencies;
}

bool contains(const msgs::TrafficSnapshot& snapshot, const std::string& vehicle_id) {
  return std::any_of(snapshot.vehicles.begin(), snapshot.vehicles.end(),
                     [&](const msgs::Vehicle& vehicle) { return vehicle.id == vehicle_id; });
}

std::uint64_t TickAnswers::tickOf(const msgs::ControlAction& control,
                                  std::uint64_t otherwise) const {
  if (control.tick != 0) return control.tick;
  if (control.header.stamp.isZero()) return otherwise;
  return nearestTick(control.header.stamp, simulation_step_);
}

void TickAnswers::add(const Selection& selection) {
  selections_.emplace(selection->tick, selection);
}

void TickAnswers::add(const Guidance& guidance) { guidance_.emplace(guidance->tick, guidance); }

std::uint64_t TickAnswers::addEgo(const Control& control, std::uint64_t otherwise) {
  const std::uint64_t tick = tickOf(*control, otherwise);
  controls_[tick].emplace(kEgoSlot, control);
  return tick;
}

void TickAnswers::addCbv(int slot, const Control& control) {
  controls_[control->tick].emplace(slot, control);
}

void TickAnswers::add(const Decision& record) {
  decisions_.emplace(record->tick, record);
  for (const msgs::DecidedVehicle& vehicle : record->vehicles) {
    if (!vehicle.answered) continue;
    controls_[record->tick].emplace(vehicle.slot,
                                    boost::make_shared<const msgs::ControlAction>(vehicle.answer));
  }
}

void TickAnswers::addRollout(int slot, const Rollout& rollout) {
  rollouts_[rollout->tick].emplace(slot, rollout);
}

/// What a vehicle of the tick still needs.
std::vector<std::string> TickAnswers::missingOf(int slot, std::uint64_t tick) const {
  const bool ego = slot == kEgoSlot;
  std::vector<std::string> topics;
  if (!cbv(slot, tick)) topics.push_back(ego ? kEgoControlTopic : cbvControlTopic(slot));
  if (expected_.rollouts && !ego && !rollout(slot, tick)) topics.push_back(cbvRolloutTopic(slot));
  const bool image_expected = ego ? expected_.ego_image : expected_.cbv_images;
  if (image_expected && !image(slot, tick)) topics.push_back(imageTopic(slot));
  return topics;
}

/// What the record names and has not come on its own topic; its controls it carries itself.
std::vector<std::string> TickAnswers::missingOf(const msgs::DecisionRecord& record) const {
  std::vector<std::string> topics;
  const std::uint64_t tick = record.tick;
  if (record.selection_came && !selection(tick)) topics.emplace_back(kSelectionTopic);
  bool any_cbv = false;
  for (const msgs::DecidedVehicle& vehicle : record.vehicles) {
    if (!vehicle.answered) continue;
    const bool ego = vehicle.slot == kEgoSlot;
    any_cbv = any_cbv || !ego;
    if (expected_.rollouts && !ego && !rollout(vehicle.slot, tick))
      topics.push_back(cbvRolloutTopic(vehicle.slot));
    // A planner that says what was wrong may have had no image.
    const bool saw =
        (ego ? expected_.ego_image : expected_.cbv_images) && vehicle.answer.fault.empty();
    if (saw && !image(vehicle.slot, tick)) topics.push_back(imageTopic(vehicle.slot));
  }
  if (expected_.guidance && any_cbv && !guidance(tick)) topics.emplace_back(kGuidanceTopic);
  return topics;
}

std::vector<std::string> TickAnswers::missing(const msgs::TrafficSnapshot& snapshot) const {
  std::vector<std::string> topics;
  if (!snapshot.decision_tick) return topics;
  if (const Decision record = decision(snapshot.tick)) return missingOf(*record);
  if (expected_.record) return {kDecisionRecordTopic};
  if (findEgo(snapshot) != nullptr) topics = missingOf(kEgoSlot, snapshot.tick);
  const Selection chosen = selection(snapshot.tick);
  if (!chosen) {
    topics.emplace_back(kSelectionTopic);
    return topics;
  }
  bool any_cbv = false;
  for (const msgs::CbvAssignment& assignment : chosen->assignments) {
    if (!contains(snapshot, assignment.vehicle_id)) continue;
    any_cbv = true;
    for (std::string& topic : missingOf(assignment.slot, snapshot.tick))
      topics.push_back(std::move(topic));
  }
  if (expected_.guidance && any_cbv && !guidance(snapshot.tick))
    topics.emplace_back(kGuidanceTopic);
  return topics;
}

TickAnswers::Decision TickAnswers::decision(std::uint64_t tick) const {
  const auto found = decisions_.find(tick);
  return found == decisions_.end() ? nullptr : found->second;
}

TickAnswers::Selection TickAnswers::selection(std::uint64_t tick) const {
  const Decision record = decision(tick);
  if (record && !record->selection_came) return nullptr;
  const auto found = selections_.find(tick);
  return found == selections_.end() ? nullptr : found->second;
}

TickAnswers::Control TickAnswers::cbv(int slot, std::uint64_t tick) const {
  return findIn(controls_, slot, tick);
}

TickAnswers::Rollout TickAnswers::rollout(int slot, std::uint64_t tick) const {
  return findIn(rollouts_, slot, tick);
}

TickAnswers::Guidance TickAnswers::guidance(std::uint64_t tick) const {
  const auto found = guidance_.find(tick);
  return found == guidance_.end() ? nullptr : found->second;
}

void TickAnswers::addGuidance(Answer& answer, std::uint64_t tick) const {
  const Guidance report = guidance(tick);
  if (!report) return;
  for (const msgs::VehicleGuidance& vehicle : report->vehicles) {
    if (vehicle.vehicle_id != answer.action.vehicle_id) continue;
    answer.action.guidance = fromMsg(vehicle);
    answer.action.state_mismatch = vehicle.state_mismatch;
  }
}

/// Marks an answer that came too late to drive.
void TickAnswers::addTiming(Answer& answer, std::uint64_t tick) const {
  const Decision record = decision(tick);
  if (!record) return;
  for (const msgs::DecidedVehicle& vehicle : record->vehicles) {
    if (vehicle.slot == answer.action.slot && vehicle.vehicle_id == answer.action.vehicle_id)
      answer.drove = vehicle.answer_drove != 0;
  }
}

TickAnswers::Control TickAnswers::ego(std::uint64_t tick) const { return cbv(kEgoSlot, tick); }

std::vector<Answer> TickAnswers::answers(const msgs::TrafficSnapshot& snapshot) const {
  std::vector<Answer> answers;
  const msgs::Vehicle* ego_vehicle = findEgo(snapshot);
  const Control ego_control = ego(snapshot.tick);
  if (ego_vehicle != nullptr && ego_control)
    answers.push_back(answerOf(*ego_control, kEgoSlot, ego_vehicle->id));
  const Selection chosen = selection(snapshot.tick);
  if (!chosen) return answers;
  for (const msgs::CbvAssignment& assignment : chosen->assignments) {
    const Control control = cbv(assignment.slot, snapshot.tick);
    if (!control || !contains(snapshot, assignment.vehicle_id)) continue;
    answers.push_back(answerOf(*control, assignment.slot, assignment.vehicle_id));
    addGuidance(answers.back(), snapshot.tick);
    if (const Rollout plan = rollout(assignment.slot, snapshot.tick))
      answers.back().action.rollout = fromMsg(*plan);
  }
  for (Answer& answer : answers) addTiming(answer, snapshot.tick);
  return answers;
}

std::vector<session::SlotImage> TickAnswers::images(const msgs::TrafficSnapshot& snapshot) const {
  std::vector<session::SlotImage> seen;
  for (const Answer& answer : answers(snapshot)) {
    const int slot = answer.action.slot;
    if (!image(slot, snapshot.tick)) continue;
    try {
      seen.push_back({slot, images_.read(slot, answer.action.vehicle_id, snapshot.tick)});
    } catch (const core::InputError&) {  // its planner has braked and said why
    }
  }
  return seen;
}

TickAnswers::TimedControl TickAnswers::newest(int slot, const std::string& vehicle_id,
                                              std::uint64_t tick) const {
  for (auto at_tick = controls_.rbegin(); at_tick != controls_.rend(); ++at_tick) {
    const auto found = at_tick->second.find(slot);
    if (at_tick->first > tick || found == at_tick->second.end()) continue;
    if (slot == kEgoSlot || found->second->vehicle_id == vehicle_id)
      return {at_tick->first, found->second};
  }
  return {};
}

TickAnswers::TimedControl TickAnswers::within(int slot, std::uint64_t begin,
                                              std::uint64_t end) const {
  for (auto at_tick = controls_.lower_bound(begin);
       at_tick != controls_.end() && at_tick->first < end; ++at_tick) {
    const auto found = at_tick->second.find(slot);
    if (found != at_tick->second.end()) return {at_tick->first, found->second};
  }
  return {};
}

bool TickAnswers::answeredFrom(int slot, std::uint64_t begin) const {
  const bool ego = slot == kEgoSlot;
  return std::any_of(controls_.lower_bound(begin), controls_.end(), [&](const auto& at_tick) {
    const auto& slots = at_tick.second;
    return ego ? slots.count(kEgoSlot) > 0 : slots.upper_bound(kEgoSlot) != slots.end();
  });
}

TickAnswers::Selection TickAnswers::firstSelection() const {
  return selections_.empty() ? nullptr : selections_.begin()->second;
}

TickAnswers::Selection TickAnswers::selectionAfter(std::uint64_t tick) const {
  const auto found = selections_.upper_bound(tick);
  return found == selections_.end() ? nullptr : found->second;
}

void TickAnswers::forgetBefore(std::uint64_t tick) {
  selections_.erase(selections_.begin(), selections_.lower_bound(tick));
  controls_.erase(controls_.begin(), controls_.lower_bound(tick));
  decisions_.erase(decisions_.begin(), decisions_.lower_bound(tick));
  guidance_.erase(guidance_.begin(), guidance_.lower_bound(tick));
  rollouts_.erase(rollouts_.begin(), rollouts_.lower_bound(tick));
  images_.forgetBefore(tick);
}

}  // namespace cdiff::ros
