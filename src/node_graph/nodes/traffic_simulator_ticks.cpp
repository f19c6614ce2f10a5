// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The ticks of a session: publish, wait, advance.
#include <algorithm>
#include <cmath>
#include <set>

#include "node_graph/lockstep/node_process.h"
#include "node_graph/lockstep/tick_record.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/nodes/traffic_simulator_node.h"
#include "rosgraph_msgs/Clock.h"

namespace cdiff::node_graph {
namespace {

using traffic::SessionStatus;

constexpr double kSendAgainAfter =
    1.0;  // [s] of wall time without an answer of an external ego planner

constexpr double kPacedSilence =
    10.0;  // [s] of wall time: with a pace to keep, a node that says nothing for so long is lost

}  // namespace

/// A node of the user may connect while the first snapshot is sent; it gets the same snapshot
/// again.
void TrafficSimulatorNode::sendAgainForLateListener() {
  if (!graph_.external_ego || !published_ || secondsSince(published_at_) < kSendAgainAfter) return;
  if (answers_.has(ChannelId::kEgoControl, published_->tick)) return;
  traffic_.publish(published_);
  published_at_ = Clock::now();
}

void TrafficSimulatorNode::runTicks() {
  publishTick();
  while (world_->snapshot().status == SessionStatus::kRunning) {
    if (const auto ending = paced() ? waitUntilDue() : waitForTick()) {
      endSession(*ending);
    } else if (paced()) {
      advancePaced();
    } else {
      advance();
    }
    publishTick();
  }
}

void TrafficSimulatorNode::publishTick() {
  const traffic::TrafficSnapshot& snapshot = world_->snapshot();
  if (snapshot.status != SessionStatus::kRunning) closeDecisions();
  msgs::TrafficSnapshot message = toMsg(snapshot);
  message.late_answers = decisions_->late();
  if (snapshot.status != SessionStatus::kRunning) addTotals(message);
  rosgraph_msgs::Clock clock;
  clock.clock = message.header.stamp;
  published_ = boost::make_shared<const msgs::TrafficSnapshot>(std::move(message));
  clock_.publish(clock);
  gate_.setNewestTick(published_->tick, setup_->options().simulation_step);
  traffic_.publish(published_);
  published_at_ = Clock::now();
  display_.publish(snapshot);
  recorded_ = !published_->decision_tick;
  if (paced() && published_->decision_tick) decisions_->open(published_);
  if (paced()) unsettled_.push_back(published_);
}

/// How much was ignored, in the last snapshot.
void TrafficSimulatorNode::addTotals(msgs::TrafficSnapshot& message) const {
  for (const std::string& text : gate_.totals()) {
    message.faults.emplace_back();
    message.faults.back().tick = message.tick;
    message.faults.back().source = kTrafficSimulatorNode;
    message.faults.back().text = text;
  }
}

std::vector<TrafficSimulatorNode::Missing> TrafficSimulatorNode::missingAnswers() const {
  std::vector<Missing> missing;
  for (const Topic& topic : answers_.missing(*published_)) {
    const std::string node = answererOf(topic, graph_);
    missing.push_back(
        {node, topic.name() + " for tick " + std::to_string(published_->tick) + " (" + node + ")"});
  }
  return missing;
}

std::vector<TrafficSimulatorNode::Missing> TrafficSimulatorNode::missingAtTick() const {
  std::vector<Missing> missing = missingAnswers();
  for (const std::string& node : book_.notAcknowledged(published_->tick)) {
    missing.push_back(
        {node, node + "'s acknowledgement of tick " + std::to_string(published_->tick)});
  }
  return missing;
}

std::optional<TrafficSimulatorNode::Ending> TrafficSimulatorNode::waitForTick() {
  if (graph_.external_ego && !recorded_) {  // observers wait for the record
    if (auto cause = waitFor([this] { return missingAnswers(); }, limits_.answer)) return cause;
    closeDecisions();
  }
  if (auto cause = waitFor([this] { return missingAtTick(); }, limits_.answer)) return cause;
  const double at_most = setup_->options().at_most;
  return at_most > 0.0 ? sleepUntil(published_->time / at_most) : std::nullopt;
}

/// `due`: wall time since the first tick [s].
std::optional<TrafficSimulatorNode::Ending> TrafficSimulatorNode::sleepUntil(double due) {
  while (true) {
    if (auto cause = disturbance()) return cause;
    const double left = due - secondsSince(begin_);
    if (left <= 0.0) return std::nullopt;
    spin(std::min(left, kSpinPeriod));
  }
}

/// Paced by the wall clock: the tick ends when its time has come, whatever has been answered.
std::optional<TrafficSimulatorNode::Ending> TrafficSimulatorNode::waitUntilDue() {
  const session::ScenarioOptions& options = setup_->options();
  spin(0.0);  // what has arrived counts, however late this tick began
  const double due = (published_->time + options.simulation_step) / options.real_time_factor;
  if (auto cause = sleepUntil(due)) return cause;
  const double patience = std::min(limits_.answer, kPacedSilence);
  if (const auto missing = silentFor(patience); !missing.empty())
    return endOfPatience(missing, patience);
  const std::vector<std::string> behind = book_.notAcknowledged(published_->tick);
  const std::uint64_t acknowledged = book_.acknowledgedByAll();  // they lag where answers do
  if (behind.empty() || published_->tick == 0 || acknowledged > acknowledged_)
    acknowledged_at_ = Clock::now();
  acknowledged_ = acknowledged;
  if (secondsSince(acknowledged_at_) <= limits_.answer) return std::nullopt;
  return endOfPatience({{behind.front(), behind.front() + "'s acknowledgement of a tick"}},
                       limits_.answer);
}

/// A late answer is replaced; a node that is not heard at all ends the session.
std::vector<TrafficSimulatorNode::Missing> TrafficSimulatorNode::silentFor(double seconds) const {
  std::vector<Missing> missing;
  for (const std::string& node : book_.silent(seconds))
    missing.push_back({node, "a sign of life of " + node});
  if (graph_.external_ego && secondsSince(std::max(ego_heard_at_, begin_)) > seconds)
    missing.push_back({answererOf(ChannelId::kEgoControl, graph_),
                       "a command on " + Topic(ChannelId::kEgoControl).name()});
  return missing;
}

/// An ego that came to stand after a node was last heard may brake for want of that node: it is not
/// blocked before the node answers again; otherwise its silence ends the session.
bool TrafficSimulatorNode::standsPerhapsForSilence() const {
  const std::optional<double> since = world_->egoStandsSince();
  if (!since) return false;
  const double stood = world_->snapshot().time - *since;
  return !silentFor(stood / setup_->options().real_time_factor).empty();
}

void TrafficSimulatorNode::recordFaults(const std::vector<Answer>& answers) {
  std::set<std::pair<std::string, std::string>> recorded;  // all CBVs share one planning call
  for (const Answer& answer : answers) {
    if (!answer.fault.empty() && recorded.emplace(answer.planner, answer.fault).second)
      world_->recordFault(answer.planner, answer.fault);
  }
}

void TrafficSimulatorNode::advance() {
  if (!published_->decision_tick) {
    keepInReserve(nullptr, {}, {});
    world_->advance(nullptr, {});
    return;
  }
  const std::vector<Answer> answers = answers_.answers(*published_);
  recordFaults(answers);
  const cbv::CbvSelection selection =
      fromMsg(*answers_.selection(published_->tick), setup_->network());
  const std::vector<planning::PlannedAction> actions = actionsOf(answers);
  keepInReserve(&selection, actions, answers);
  world_->advance(&selection, actions);
  answers_.forgetBefore(published_->tick);
}

void TrafficSimulatorNode::keepInReserve(const cbv::CbvSelection* selection,
                                         const std::vector<planning::PlannedAction>& actions,
                                         const std::vector<Answer>& answers) {
  session::TickRecord record;
  record.snapshot = &world_->snapshot();
  record.selection = selection;
  if (selection != nullptr) record.actions = &actions;
  record.latencies = latenciesOf(answers);
  reserve_->observe(record);
}

void TrafficSimulatorNode::publishRecord(const msgs::DecisionRecord::ConstPtr& record) {
  records_.publish(record);
  answers_.add(ChannelId::kDecisionRecord, record);
}

/// The session goes on, or ends, with what has arrived.
void TrafficSimulatorNode::closeDecisions() {
  if (paced()) return settleDecisions(true);
  if (graph_.external_ego && !recorded_) {
    publishRecord(
        boost::make_shared<const msgs::DecisionRecord>(punctualRecord(*published_, answers_)));
  }
  recorded_ = true;
}

void TrafficSimulatorNode::settleDecisions(bool all) {
  if (!published_) return;
  for (const auto& record : decisions_->settle(answers_, published_->tick, all)) {
    publishRecord(record);
    for (const auto& [planner, text] : latenessTexts(*record)) {
      if (late_planners_.insert(planner).second) world_->recordFault(planner, text);
    }
  }
  keepSettledInReserve();
}

void TrafficSimulatorNode::keepSettledInReserve() {
  while (!unsettled_.empty()) {
    const msgs::TrafficSnapshot& snapshot = *unsettled_.front();
    if (snapshot.decision_tick && !answers_.decision(snapshot.tick)) return;
    recordFaults(answers_.answers(snapshot));
    reserve_->observe(TickRecordView(snapshot, answers_, setup_->network()).record());
    unsettled_.pop_front();
  }
}

void TrafficSimulatorNode::advancePaced() {
  const auto taken = paced_answers_.selection(*published_, answers_);
  const auto applied = paced_answers_.actions(*published_, taken, answers_);
  decisions_->ended(published_->tick, applied, secondsSince(begin_));
  settleDecisions(false);
  world_->withholdBlocked(standsPerhapsForSilence());
  if (taken) {
    const cbv::CbvSelection selection = fromMsg(*taken, setup_->network());
    world_->advance(&selection, actionsOf(applied));
  } else {
    world_->advance(nullptr, actionsOf(applied));
  }
  forgetSettled();
}

/// Plans drive for a while; answers to open decisions are still wanted for their records.
void TrafficSimulatorNode::forgetSettled() {
  const auto kept =
      static_cast<std::uint64_t>(std::llround(2.0 / setup_->options().simulation_step));
  const std::uint64_t oldest =
      std::min(decisions_->oldestOpen().value_or(published_->tick),
               unsettled_.empty() ? published_->tick : unsettled_.front()->tick);
  answers_.forgetBefore(std::min(oldest, published_->tick - std::min(kept, published_->tick)));
}

}  // namespace cdiff::node_graph
