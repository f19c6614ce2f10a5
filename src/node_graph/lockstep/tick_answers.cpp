// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/tick_answers.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>

#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {

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

std::vector<session::SlotImage> imagesOf(const std::vector<Answer>& answers) {
  std::vector<session::SlotImage> images;
  for (const Answer& answer : answers) {
    images.insert(images.end(), answer.images.begin(), answer.images.end());
  }
  return images;
}

AnyMessage TickMessages::find(const Topic& topic) const {
  const auto found = messages_.find(topic);
  return found == messages_.end() ? nullptr : found->second;
}

bool TickMessages::holds(ChannelId id) const {
  const auto first = messages_.lower_bound({id, kEgoSlot, ""});
  return first != messages_.end() && first->first.id == id;
}

AnyMessage makeMessage(const Topic& topic, const TickValues& values) {
  const MakeMessage make = topic.row().make;
  return make == nullptr ? nullptr : make(values, topic);
}

TickMessages makeMessages(const TickValues& values, int max_cbv, const session::VehicleRigs& rigs) {
  TickMessages messages;
  for (const Channel& row : channels()) {
    for (const Topic& topic : topicsOf(row, max_cbv, rigs)) {
      if (const AnyMessage message = makeMessage(topic, values)) messages.add(topic, message);
    }
  }
  return messages;
}

std::optional<Answer> readAnswer(const TickMessages& tick, int slot, const std::string& vehicle_id,
                                 const TickReading& reading) {
  if (!tick.find(controlOf(slot))) return std::nullopt;
  Answer answer;
  answer.action.slot = slot;
  answer.action.vehicle_id = vehicle_id;
  const Scope other = slot == kEgoSlot ? Scope::kSlot : Scope::kEgo;
  for (const Channel& row : channels()) {
    if (row.take == nullptr || row.scope == other) continue;
    for (const Topic& topic :
         topicsOfSlot(row, row.scope == Scope::kSlot ? slot : kEgoSlot, reading.rigs)) {
      if (const AnyMessage message = tick.find(topic)) row.take({message, topic}, reading, answer);
    }
  }
  return answer;
}

namespace {

const msgs::Vehicle* findEgo(const msgs::TrafficSnapshot& snapshot) {
  const auto found =
      std::find_if(snapshot.vehicles.begin(), snapshot.vehicles.end(),
                   [](const msgs::Vehicle& vehicle) { return vehicle.role == msgs::Vehicle::EGO; });
  return found == snapshot.vehicles.end() ? nullptr : &*found;
}

void append(std::vector<Topic>& topics, const std::vector<Topic>& more) {
  topics.insert(topics.end(), more.begin(), more.end());
}

}  // namespace

bool contains(const msgs::TrafficSnapshot& snapshot, const std::string& vehicle_id) {
  return std::any_of(snapshot.vehicles.begin(), snapshot.vehicles.end(),
                     [&](const msgs::Vehicle& vehicle) { return vehicle.id == vehicle_id; });
}

TickAnswers::TickAnswers(double simulation_step)
    : TickAnswers(simulation_step, awaitedBy(Party::kSimulator, SessionGraph())) {}

TickAnswers::TickAnswers(double simulation_step, ChannelSet awaited,
                         const session::VehicleRigs& rigs)
    : awaited_(std::move(awaited)), reading_{rigs, simulation_step} {}

std::uint64_t TickAnswers::add(const Topic& topic, const AnyMessage& message,
                               std::uint64_t otherwise) {
  const std::uint64_t tick =
      topic.row().type.tick(message, reading_.simulation_step).value_or(otherwise);
  ticks_[tick].add(topic, message);
  if (topic.id != ChannelId::kDecisionRecord) return tick;
  for (const msgs::DecidedVehicle& vehicle : messageAs<msgs::DecisionRecord>(message)->vehicles) {
    if (vehicle.answered) ticks_[tick].add(controlOf(vehicle.slot), shared(vehicle.answer));
  }
  return tick;
}

AnyMessage TickAnswers::find(const Topic& topic, std::uint64_t tick) const {
  const auto found = ticks_.find(tick);
  return found == ticks_.end() ? nullptr : found->second.find(topic);
}

TickMessages TickAnswers::messages(std::uint64_t tick) const {
  const auto found = ticks_.find(tick);
  TickMessages messages = found == ticks_.end() ? TickMessages() : found->second;
  if (!selection(tick)) messages.remove(ChannelId::kSelection);
  return messages;
}

/// What a vehicle of the tick still needs; a planner that answers with a fault may have had no
/// image.
std::vector<Topic> TickAnswers::missingOf(int slot, std::uint64_t tick, bool with_fault) const {
  const Scope scope = slot == kEgoSlot ? Scope::kEgo : Scope::kSlot;
  std::vector<Topic> topics;
  for (const ChannelId id : awaited_) {
    const Channel& row = channel(id);
    const bool needed = row.need == Need::kVehicle || (row.need == Need::kSight && !with_fault);
    if (row.scope != scope || !needed) continue;
    for (const Topic& topic : topicsOfSlot(row, slot, reading_.rigs)) {
      if (!has(topic, tick)) topics.push_back(topic);
    }
  }
  return topics;
}

/// What the tick needs once.
std::vector<Topic> TickAnswers::missingOfSession(Need need, std::uint64_t tick) const {
  std::vector<Topic> topics;
  for (const ChannelId id : awaited_) {
    if (channel(id).need == need && !has(id, tick)) topics.emplace_back(id);
  }
  return topics;
}

/// What the record names and has not come on its own topic; its controls it carries itself.
std::vector<Topic> TickAnswers::missingOf(const msgs::DecisionRecord& record) const {
  std::vector<Topic> topics;
  if (record.selection_came) topics = missingOfSession(Need::kDecision, record.tick);
  bool any_cbv = false;
  for (const msgs::DecidedVehicle& vehicle : record.vehicles) {
    if (!vehicle.answered) continue;
    any_cbv = any_cbv || vehicle.slot != kEgoSlot;
    append(topics, missingOf(vehicle.slot, record.tick, !vehicle.answer.fault.empty()));
  }
  if (any_cbv) append(topics, missingOfSession(Need::kAnyCbv, record.tick));
  return topics;
}

std::vector<Topic> TickAnswers::missing(const msgs::TrafficSnapshot& snapshot) const {
  std::vector<Topic> topics;
  const std::uint64_t tick = snapshot.tick;
  if (!snapshot.decision_tick) return topics;
  if (const Decision record = decision(tick)) return missingOf(*record);
  topics = missingOfSession(Need::kRecord, tick);
  if (!topics.empty()) return topics;
  if (findEgo(snapshot) != nullptr) topics = missingOf(kEgoSlot, tick);
  append(topics, missingOfSession(Need::kDecision, tick));
  const Selection chosen = selection(tick);
  if (!chosen) return topics;
  bool any_cbv = false;
  for (const msgs::CbvAssignment& assignment : chosen->assignments) {
    if (!contains(snapshot, assignment.vehicle_id)) continue;
    any_cbv = true;
    append(topics, missingOf(assignment.slot, tick));
  }
  if (any_cbv) append(topics, missingOfSession(Need::kAnyCbv, tick));
  return topics;
}

TickAnswers::Selection TickAnswers::selection(std::uint64_t tick) const {
  const Decision record = decision(tick);
  if (record && !record->selection_came) return nullptr;
  return get<msgs::CbvSelection>(ChannelId::kSelection, tick);
}

std::vector<Answer> TickAnswers::answers(const msgs::TrafficSnapshot& snapshot) const {
  std::vector<Answer> answers;
  const auto tick = ticks_.find(snapshot.tick);
  if (tick == ticks_.end()) return answers;
  const auto take = [&](int slot, const std::string& vehicle_id) {
    if (auto answer = readAnswer(tick->second, slot, vehicle_id, reading_))
      answers.push_back(std::move(*answer));
  };
  if (const msgs::Vehicle* ego = findEgo(snapshot)) take(kEgoSlot, ego->id);
  const Selection chosen = selection(snapshot.tick);
  if (!chosen) return answers;
  for (const msgs::CbvAssignment& assignment : chosen->assignments) {
    if (contains(snapshot, assignment.vehicle_id)) take(assignment.slot, assignment.vehicle_id);
  }
  return answers;
}

TickAnswers::TimedControl TickAnswers::newest(int slot, const std::string& vehicle_id,
                                              std::uint64_t tick) const {
  for (auto at = ticks_.rbegin(); at != ticks_.rend(); ++at) {
    if (at->first > tick) continue;
    const auto found = at->second.get<msgs::ControlAction>(controlOf(slot));
    if (found && (slot == kEgoSlot || found->vehicle_id == vehicle_id)) return {at->first, found};
  }
  return {};
}

TickAnswers::TimedControl TickAnswers::within(int slot, std::uint64_t begin,
                                              std::uint64_t end) const {
  for (auto at = ticks_.lower_bound(begin); at != ticks_.end() && at->first < end; ++at) {
    if (const auto found = at->second.get<msgs::ControlAction>(controlOf(slot)))
      return {at->first, found};
  }
  return {};
}

bool TickAnswers::answeredFrom(int slot, std::uint64_t begin) const {
  return std::any_of(ticks_.lower_bound(begin), ticks_.end(),
                     [&](const auto& tick) { return tick.second.holds(controlOf(slot).id); });
}

TickAnswers::Selection TickAnswers::selectionFrom(std::uint64_t tick) const {
  for (auto at = ticks_.lower_bound(tick); at != ticks_.end(); ++at) {
    if (const auto found = at->second.get<msgs::CbvSelection>(ChannelId::kSelection)) return found;
  }
  return nullptr;
}

void TickAnswers::forgetBefore(std::uint64_t tick) {
  ticks_.erase(ticks_.begin(), ticks_.lower_bound(tick));
}

}  // namespace cdiff::node_graph
