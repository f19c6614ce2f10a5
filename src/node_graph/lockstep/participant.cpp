// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/participant.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "core/markup.h"
#include "core/text.h"
#include "node_graph/bags/replay.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_graph.h"
#include "ros/callback_queue.h"

namespace cdiff::node_graph {
namespace {

constexpr double kPeriod =
    0.1;  // [s] of wall time between looks at the signals, and between ready messages
constexpr double kAlivePeriod = 1.0;  // [s] between messages of a node that waits for others
constexpr double kStopPatience =
    6.0;  // [s] after a stop signal until a node leaves without a last snapshot
constexpr double kFarewell = 3.0;  // [s] for the last messages to arrive
/// Simulated time by which an answer may come before its snapshot [s]: nothing waits for a node of
/// which no vehicle needs an answer, so it may lag behind far; beyond that the bound is one of
/// memory.
constexpr double kLead = 100.0;
constexpr double kFirstHeartbeat = 30.0;  // [s] for a simulator of the same launch to begin

void spin() { nodeQueue().callAvailable(ros::WallDuration(kPeriod)); }

double secondsSince(const ros::SteadyTime& begin) {
  return (ros::SteadyTime::now() - begin).toSec();
}

}  // namespace

std::string simulatorFault(Ending ending, double timeout) {
  if (ending != Ending::kSimulatorSilent) return "the node left the session";
  if (timeout == 0.0) return "the node has sent nothing since it was started";
  return "the node has sent nothing for " + core::formatNumber(timeout) + " s";
}

Participant::Participant(StopSignal& stop) : stop_(stop), name_(baseName(nodeName())) {
  acks_ = connections_.advertise<msgs::TickAck>(node_, Topic(ChannelId::kTickAck).name(),
                                                {kTrafficSimulatorNode});
  gate_.setReport([this](const std::string& text) {
    ROS_WARN("%s: %s", name_.c_str(), core::plainText(text).c_str());
    publishAck(msgs::TickAck::FAULT, lastTick(), text);
  });
  heartbeat_input_ = gate_.subscribe<msgs::Heartbeat>(
      node_, Topic(ChannelId::kHeartbeat).name(), siblingNodes({kTrafficSimulatorNode}),
      [this](const auto& message) { heartbeat_.heard(message->timeout); });
  session_input_ = gate_.subscribe<msgs::SessionInfo>(
      node_, Topic(ChannelId::kSession).name(), siblingNodes({kTrafficSimulatorNode}),
      [this](const auto& message) { session_ = message; });
}

ros::Publisher Participant::advertise(const Topic& topic) {
  const Channel& row = topic.row();
  return row.type.advertise(connections_, node_, topic.name(), listeners(topic, graph_),
                            isLatched(row));
}

void Participant::listen(const Topic& topic, const TakeMessage& take) {
  inputs_.push_back(topic.row().type.subscribe(gate_, node_, topic.name(),
                                               siblingNodes(publishersOf(topic, graph_)), take));
}

int Participant::run() {
  try {
    if (const auto ending = waitForSession()) {
      if (*ending == Ending::kStopped) return core::ExitCode::kPassed;
      const int exit_code = concludeUnstarted(*ending);
      if (*ending == Ending::kSimulatorSilent) endSilentSimulator();
      return exit_code;
    }
    if (graph_.has(name_)) return runSession();
    return standBy();
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}

/// The session does not need this node. If it left, it would be one that "has died" to roswtf.
int Participant::standBy() {
  ROS_DEBUG("%s: the session does not need this node", name_.c_str());
  session_input_.shutdown();
  openDiagnostics();
  while (ros::ok() && !stop_.raised() && !simulatorGone() && !simulatorSilent()) {
    diagnostics_->update();
    spin();
  }
  return core::ExitCode::kPassed;
}

/// Returns how it ended where no session has begun.
std::optional<Ending> Participant::waitForSession() {
  while (!session_ || !stopped_at_.isZero()) {
    if (const auto ending = unstartedEnding()) return ending;
    spin();
  }
  graph_ = graphOf(*session_);
  return std::nullopt;
}

std::optional<Ending> Participant::unstartedEnding() {
  if (!ros::ok()) return Ending::kStopped;
  if (simulatorSilent()) return Ending::kSimulatorSilent;
  if (hostsNodes() && simulatorGone()) return Ending::kSimulatorGone;
  const bool overdue = !heartbeat_.everHeard() && secondsSince(began_) > kFirstHeartbeat;
  if (overdue && launchedProcess(kTrafficSimulatorNode)) return Ending::kSimulatorSilent;
  if (!stop_.raised()) return std::nullopt;
  if (stopped_at_.isZero()) stopped_at_ = ros::SteadyTime::now();
  // The simulator was stopped too and writes a result, or its death is why roslaunch stops us.
  if (!nodeRuns(kTrafficSimulatorNode)) return Ending::kSimulatorGone;
  if (secondsSince(stopped_at_) > kStopPatience) return Ending::kStopped;
  return std::nullopt;
}

/// One line in /diagnostics, once a second of the node's time.
void Participant::openDiagnostics() {
  diagnostics_ =
      std::make_unique<diagnostic_updater::Updater>(node_, privateNodeHandle(), nodeName());
  diagnostics_->setHardwareID("session");
  diagnostics_->add(subject(), [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    const bool needed = graph_.has(name_);
    status.summary(diagnostic_msgs::DiagnosticStatus::OK,
                   needed ? "takes part" : "stands by: the session does not need it");
    if (!needed) return;
    status.add("last tick", lastTick());
    status.add("ticks that wait", snapshots_.size());
    diagnose(status);
  });
}

int Participant::runSession() {
  startSession(*session_);
  openDiagnostics();
  const session::ScenarioOptions options = optionsFromMsg(*session_);
  simulation_step_ = options.simulation_step;
  lag_ = mayLag() && !graph_.paced && !isReplay(*session_) ? kMostLag : 0;
  lead_ = static_cast<std::uint64_t>(
      std::llround((options.decision_period + kLead) / simulation_step_));
  traffic_input_ = gate_.subscribe<msgs::TrafficSnapshot>(
      node_, Topic(ChannelId::kTraffic).name(), siblingNodes({kTrafficSimulatorNode}),
      [this](const auto& message) { queue(message); });
  while (!handleQueue()) {
    if (const auto ending = unexpectedEnding()) return leave(*ending);
    report();
    diagnostics_->update();
    spin();
  }
  return leave(Ending::kFinalSnapshot);
}

std::optional<Ending> Participant::unexpectedEnding() {
  if (!ros::ok()) return Ending::kStopped;
  if (simulatorGone()) return Ending::kSimulatorGone;
  if (simulatorSilent()) return Ending::kSimulatorSilent;
  if (stop_.raised() && stopped_at_.isZero()) stopped_at_ = ros::SteadyTime::now();
  if (!stopped_at_.isZero() && secondsSince(stopped_at_) > kStopPatience) return Ending::kStopped;
  return std::nullopt;
}

bool Participant::simulatorSilent() { return heartbeat_.silent(ros::SteadyTime::now().toSec()); }

void Participant::queue(const Snapshot& snapshot) {
  if (snapshot->tick < next_tick_) return;  // sent again for a late listener
  next_tick_ = snapshot->tick + 1;
  gate_.setNewestTick(snapshot->tick + lead_, simulation_step_);
  arrived(*snapshot);
  snapshots_.push_back(snapshot);
  changed_at_ = ros::SteadyTime::now();
}

/// Whether nothing more comes of the oldest snapshot: the simulator, which waits for the answers to
/// it, would not have gone on so far, or has ended the session.
bool Participant::superseded() const {
  constexpr double kOnTheirWay = 0.5;  // [s] of wall time for messages at the end of a session
  if (snapshots_.size() < 2 || leavesOut()) return false;
  if (snapshots_.back()->tick - snapshots_.front()->tick > lag_) return true;
  return ended() && secondsSince(changed_at_) > kOnTheirWay;
}

/// Returns whether the last snapshot of the session has been handled.
bool Participant::handleQueue() {
  if (leavesOut()) leaveOutdatedOut();
  while (!snapshots_.empty() && handle(snapshots_.front(), superseded())) {
    final_handled_ = snapshots_.front()->status != msgs::TrafficSnapshot::RUNNING;
    snapshots_.pop_front();
    changed_at_ = ros::SteadyTime::now();
  }
  return final_handled_;
}

/// Answers to older decisions would drive no vehicle once the newest that can be answered is
/// answered.
void Participant::leaveOutdatedOut() {
  constexpr std::size_t kMost = 40;  // snapshots that wait for what a decision needs
  const auto newest = std::find_if(snapshots_.rbegin(), snapshots_.rend(), [this](const auto& one) {
    return one->decision_tick && ready(*one);
  });
  if (newest != snapshots_.rend()) snapshots_.erase(snapshots_.begin(), newest.base() - 1);
  if (ended()) snapshots_.erase(snapshots_.begin(), snapshots_.end() - 1);
  while (snapshots_.size() > kMost) snapshots_.pop_front();
}

int Participant::leave(Ending ending) {
  over_ = true;
  while (isObserver(name_) && !snapshots_.empty() && handle(snapshots_.front(), true))
    snapshots_.pop_front();
  const int exit_code = conclude(ending);
  if (ending == Ending::kSimulatorSilent) endSilentSimulator();
  if (!isObserver(name_) || !ros::ok()) return exit_code;
  publishAck(msgs::TickAck::FINISHED, lastTick());
  // The simulator leaves once it knows; until then the message may still be on its way.
  const ros::SteadyTime limit = ros::SteadyTime::now() + ros::WallDuration(kFarewell);
  while (!simulatorGone() && ros::SteadyTime::now() < limit) spin();
  return exit_code;
}

/// So that it does not go on one day, and so that roslaunch ends. The metrics node ends it, once it
/// has written the result; the others only where the metrics node does not.
void Participant::endSilentSimulator() {
  const ros::SteadyTime begin = ros::SteadyTime::now();
  while (name_ != kMetricsNode && ros::ok() && !simulatorGone() && secondsSince(begin) < kFarewell)
    spin();
  if (!simulatorGone() && killLaunchedProcess(kTrafficSimulatorNode))
    ROS_ERROR("%s, silent for %g s, was ended", kTrafficSimulatorNode, heartbeat_.timeout());
}

int Participant::fail(const std::string& text) {
  ROS_ERROR("%s: %s", name_.c_str(), core::plainText(text).c_str());
  const ros::SteadyTime limit = ros::SteadyTime::now() + ros::WallDuration(kFarewell);
  while (ros::ok() && !simulatorGone() && ros::SteadyTime::now() < limit) {
    publishAck(msgs::TickAck::ERROR, lastTick(), text);
    spin();
    if (ended()) break;
  }
  return core::ExitCode::kRunTimeError;
}

void Participant::publishAck(std::uint8_t kind, std::uint64_t tick, const std::string& text) {
  msgs::TickAck message;
  message.node = name_;
  message.kind = kind;
  message.tick = tick;
  message.text = text;
  acks_.publish(shared(std::move(message)));
}

void Participant::report() {
  const bool begun = next_tick_ > 0;
  if (secondsSince(reported_at_) < (begun ? kAlivePeriod : kPeriod)) return;
  reported_at_ = ros::SteadyTime::now();
  if (begun) return publishAck(msgs::TickAck::ALIVE, lastTick());
  const std::string text = missing();
  publishAck(text.empty() ? msgs::TickAck::READY : msgs::TickAck::WAITING, 0, text);
}

std::string Participant::missing() const {
  std::vector<std::string> texts = connections_.missing();
  for (const ros::Subscriber& input : inputs_) {
    if (input.getNumPublishers() == 0)
      texts.push_back("no node publishes " + input.getTopic() + " yet");
  }
  if (!waitingFor().empty()) texts.push_back(waitingFor());
  return core::joinText(texts, ", ");
}

namespace msgs = ::e2e_cdiff;

void Observer::listenToAnswers(Party party, const session::ScenarioOptions& options) {
  answers_ = TickAnswers(options.simulation_step, awaitedBy(party, graph()), graph().rigs);
  for (const Channel& row : channels()) {
    const bool collected = row.use == Use::kAnswer || row.use == Use::kReport;
    if (!collected || !listensTo(row, party, graph())) continue;
    for (const Topic& topic : topicsOf(row, graph())) {
      listen(topic, [this, topic](const AnyMessage& message) {
        const std::string wrong = unusable(message, topic, graph());
        if (wrong.empty()) answers_.add(topic, message);
        return wrong;
      });
    }
  }
}

bool Observer::complete(const msgs::TrafficSnapshot& snapshot, bool superseded) {
  constexpr double kPatience = 0.5;  // [s] of wall time for messages that are on their way
  const bool all = answers_.missing(snapshot).empty();
  if (all || over() || (superseded && !graph().recordsDecisions())) {
    waiting_since_ = {};
    return true;
  }
  if (!superseded || !answers_.decision(snapshot.tick)) return false;
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (waiting_since_.isZero()) waiting_since_ = now;
  if ((now - waiting_since_).toSec() < kPatience) return false;
  waiting_since_ = {};
  return true;
}

}  // namespace cdiff::node_graph
