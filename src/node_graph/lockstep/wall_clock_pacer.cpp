// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/wall_clock_pacer.h"

#include <algorithm>
#include <cmath>

#include "node_graph/messages/session_conversions.h"

namespace cdiff::node_graph {
namespace {

constexpr double kLongestSilence =
    10.0;  // [s] of wall time: with a pace to keep, a node that says nothing for so long is lost

}  // namespace

WallClockPacer::WallClockPacer(const PacedSession& session, PacerOutput output)
    : Pacer(session, std::move(output)),
      paced_answers_(options().simulation_step, session.setup.ticksPerDecision()),
      decisions_(options()) {}

void WallClockPacer::take(const Topic& topic, const AnyMessage& message) {
  if (waitsForRollout(topic, message)) return;
  if (topic.id == ChannelId::kCbvControl) cbvs_heard_at_ = Clock::now();
  const bool ego = topic.id == ChannelId::kEgoControl;
  if (ego) ego_heard_at_ = Clock::now();
  const std::uint64_t tick = answers_.add(topic, message, ego && published_ ? published_->tick : 0);
  if (topic.id == ChannelId::kSelection) {
    decisions_.arrived(DecisionTracker::kSelection, tick, elapsed());
    if (messageAs<msgs::CbvSelection>(message)->assignments.empty()) cbvs_heard_at_ = Clock::now();
  }
  if (ego || topic.id == ChannelId::kCbvControl) decisions_.arrived(topic.slot, tick, elapsed());
  const auto early = early_controls_.find(topic.slot);
  if (topic.id != ChannelId::kCbvRollout || early == early_controls_.end()) return;
  const AnyMessage control = early->second;  // which the call below takes out of the map
  take({ChannelId::kCbvControl, topic.slot}, control);
}

/// A CBV's control counts with the rollout that is sent before it but on another connection, so
/// that the next action of a plan is always that of the plan. The newest control of a slot is kept
/// until then.
bool WallClockPacer::waitsForRollout(const Topic& topic, const AnyMessage& message) {
  if (topic.id != ChannelId::kCbvControl || session_.graph.external_cbvs) return false;
  early_controls_.erase(topic.slot);
  const bool waits =
      answers_.rollout(topic.slot, messageAs<msgs::ControlAction>(message)->tick) == nullptr;
  if (waits) early_controls_[topic.slot] = message;
  return waits;
}

void WallClockPacer::published(const Snapshot& snapshot) {
  published_ = snapshot;
  if (snapshot->decision_tick) decisions_.open(snapshot);
  unsettled_.push_back(snapshot);
}

std::optional<SessionEnd> WallClockPacer::wait() {
  spin(0.0);  // what has arrived counts, however late this tick began
  const double due = (published_->time + options().simulation_step) / options().real_time_factor;
  if (auto cause = session_.watch.sleepUntil(wallTime(due))) return cause;
  const double patience = std::min(session_.answer_limit, kLongestSilence);
  if (const auto missing = silentNodes(patience); !missing.empty())
    return session_.watch.endOfPatience(missing, patience);
  return overdueAcknowledgement();
}

/// Acknowledgements lag where answers do.
std::optional<SessionEnd> WallClockPacer::overdueAcknowledgement() {
  const std::vector<std::string> behind = session_.participants.notAcknowledged(published_->tick);
  const std::uint64_t acknowledged = session_.participants.acknowledgedByAll();
  if (behind.empty() || published_->tick == 0 || acknowledged > acknowledged_)
    acknowledged_at_ = Clock::now();
  acknowledged_ = acknowledged;
  if (secondsSince(acknowledged_at_) <= session_.answer_limit) return std::nullopt;
  return session_.watch.endOfPatience(
      {{behind.front(), behind.front() + "'s acknowledgement of a tick"}}, session_.answer_limit);
}

/// A late answer is replaced; a node that is not heard at all ends the session.
std::vector<Missing> WallClockPacer::silentNodes(double seconds) const {
  std::vector<Missing> missing;
  for (const std::string& node : session_.participants.silent(seconds))
    missing.push_back({node, "a sign of life of " + node});
  if (session_.graph.external_ego && secondsSince(std::max(ego_heard_at_, begin_)) > seconds)
    missing.push_back({answererOf(ChannelId::kEgoControl, session_.graph),
                       "a command on " + egoCommandOf(session_.graph).name()});
  if (session_.graph.external_cbvs && secondsSince(std::max(cbvs_heard_at_, begin_)) > seconds)
    missing.push_back(
        {answererOf({ChannelId::kCbvControl, 0}, session_.graph), "a command for any CBV"});
  return missing;
}

TickInput WallClockPacer::advance() {
  const auto taken = paced_answers_.selection(*published_, answers_);
  const auto applied = paced_answers_.actions(*published_, taken, answers_);
  decisions_.ended(published_->tick, applied, elapsed());
  settle(false);
  TickInput input;
  if (taken) input.selection = fromMsg(*taken, session_.setup.network());
  input.actions = actionsOf(applied);
  forgetSettled();
  return input;
}

void WallClockPacer::settle(bool all) {
  if (!published_) return;
  for (const auto& record : decisions_.settle(answers_, published_->tick, all)) {
    publishRecord(record);
    for (const auto& [planner, text] : latenessTexts(*record)) {
      if (late_planners_.insert(planner).second) output_.fault(planner.name, text);
    }
  }
  keepSettled();
}

void WallClockPacer::keepSettled() {
  while (!unsettled_.empty()) {
    const Snapshot snapshot = unsettled_.front();
    if (snapshot->decision_tick && !answers_.decision(snapshot->tick)) return;
    reportFaults(answers_.answers(*snapshot));
    output_.keep(snapshot, answers_);
    unsettled_.pop_front();
  }
}

/// Plans drive for a while; answers to open decisions are still wanted for their records.
void WallClockPacer::forgetSettled() {
  const auto kept = static_cast<std::uint64_t>(std::llround(2.0 / options().simulation_step));
  const std::uint64_t oldest =
      std::min(decisions_.oldestOpen().value_or(published_->tick),
               unsettled_.empty() ? published_->tick : unsettled_.front()->tick);
  answers_.forgetBefore(std::min(oldest, published_->tick - std::min(kept, published_->tick)));
}

}  // namespace cdiff::node_graph
