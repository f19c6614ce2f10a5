// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/program.h"
#include "diagnostic_updater/diagnostic_updater.h"
#include "e2e_cdiff/Heartbeat.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/TickAck.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/lockstep/participant_tracker.h"
#include "node_graph/lockstep/tick_answers.h"
#include "node_graph/messages/topics.h"
#include "ros/ros.h"
#include "session/scenario_options.h"

namespace cdiff::node_graph {

// The part that all nodes of a session but the traffic simulator share.

/// How a node's session came to its end.
enum class Ending { kFinalSnapshot, kSimulatorGone, kSimulatorSilent, kStopped };

/// What a result says about a traffic simulator that left, or fell silent for `timeout` [s].
std::string simulatorFault(Ending ending, double timeout);

/// What every node but the traffic simulator has in common: it waits for the session, reports when
/// it is connected both ways, handles snapshots tick by tick in one thread, and leaves in order
/// with the last one, whoever ends the session.
class Participant {
 public:
  explicit Participant(StopSignal& stop);
  virtual ~Participant() = default;
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// Runs the session to its end and returns the exit code.
  int run();

 protected:
  using Snapshot = ::e2e_cdiff::TrafficSnapshot::ConstPtr;

  /// The session is known: make what it needs, advertise and listen.
  virtual void startSession(const ::e2e_cdiff::SessionInfo& info) = 0;
  /// What is missing besides connections before the first tick; empty when nothing is.
  virtual std::string waitingFor() const { return {}; }
  /// A snapshot has come, in the order of ticks; it may be handled later or left out.
  virtual void arrived(const ::e2e_cdiff::TrafficSnapshot&) {}
  /// Handles the oldest snapshot; false when it needs more messages. `superseded`: nothing more of
  /// it will come.
  virtual bool handle(const Snapshot& snapshot, bool superseded) = 0;
  /// Whether all that this decision needs is here; asked where decisions may be left out.
  virtual bool ready(const ::e2e_cdiff::TrafficSnapshot&) const { return true; }
  /// Whether the node leaves decisions out when it falls behind the wall clock.
  virtual bool leavesOut() const { return false; }
  /// Whether a simulator that waits for answers goes on without this node for up to kMostLag ticks.
  virtual bool mayLag() const { return false; }
  /// What the node's line of /diagnostics is about, after its name.
  virtual std::string subject() const = 0;
  /// Adds the node's own facts to it.
  virtual void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) = 0;
  /// The session is over; returns the exit code.
  virtual int conclude(Ending ending) = 0;
  /// The traffic simulator has ended, or hangs, before it published a session; returns the exit
  /// code.
  virtual int concludeUnstarted(Ending) { return core::ExitCode::kPassed; }

  /// Throws std::logic_error unless the topic's messages are of that type, as `listen` does.
  template <class Message>
  ros::Publisher advertise(const Topic& topic) {
    requireType(topic.id, typeid(Message));
    return connections_.advertise<Message>(node_, topic.name(), listeners(topic, graph_),
                                           isLatched(topic.row()));
  }
  ros::Publisher advertise(const Topic& topic);
  /// Takes what the topic's publisher sends; see MessageGate::subscribe.
  template <class Message, class Callback>
  void listen(const Topic& topic, Callback callback) {
    requireType(topic.id, typeid(Message));
    inputs_.push_back(gate_.subscribe<Message>(
        node_, topic.name(), siblingNodes(publishersOf(topic, graph_)), callback));
  }
  void listen(const Topic& topic, const TakeMessage& take);
  /// Acknowledges a tick to the traffic simulator: this node has processed it.
  void acknowledge(std::uint64_t tick) { publishAck(::e2e_cdiff::TickAck::ACKNOWLEDGED, tick); }
  /// Reports a fault to the traffic simulator, which records it; the session goes on.
  void reportFault(const std::string& text) {
    publishAck(::e2e_cdiff::TickAck::FAULT, lastTick(), text);
  }
  const SessionGraph& graph() const { return graph_; }
  /// Whether the last snapshot of the session has come.
  bool ended() const {
    return !snapshots_.empty() &&
           snapshots_.back()->status != ::e2e_cdiff::TrafficSnapshot::RUNNING;
  }
  /// Whether no message will come any more.
  bool over() const { return over_; }
  /// For publishers that advertise() does not make.
  Connections& connections() { return connections_; }
  ros::NodeHandle& node() { return node_; }
  /// [s] of silence that the traffic simulator has promised not to exceed.
  double heartbeatTimeout() const { return heartbeat_.timeout(); }

 private:
  std::optional<Ending> waitForSession();
  std::optional<Ending> unstartedEnding();
  int standBy();
  int runSession();
  void openDiagnostics();
  std::optional<Ending> unexpectedEnding();
  void endSilentSimulator();
  int leave(Ending ending);
  int fail(const std::string& text);
  void queue(const Snapshot& snapshot);
  bool handleQueue();
  bool superseded() const;
  void leaveOutdatedOut();
  void report();
  std::string missing() const;
  bool simulatorSilent();
  bool simulatorGone() const { return connections_.hasLeft(kTrafficSimulatorNode); }
  void publishAck(std::uint8_t kind, std::uint64_t tick, const std::string& text = {});
  std::uint64_t lastTick() const { return next_tick_ == 0 ? 0 : next_tick_ - 1; }

  StopSignal& stop_;
  Connections connections_;
  MessageGate gate_;
  ros::NodeHandle node_ = nodeHandle();
  std::string name_;
  SessionGraph graph_;
  ros::Publisher acks_;
  SilenceWatch heartbeat_;
  ros::Subscriber heartbeat_input_;
  ros::Subscriber session_input_;
  ros::Subscriber traffic_input_;
  std::vector<ros::Subscriber> inputs_;
  ::e2e_cdiff::SessionInfo::ConstPtr session_;
  std::deque<Snapshot> snapshots_;
  std::uint64_t next_tick_ = 0;    ///< snapshots before it were seen
  double simulation_step_ = 0.05;  ///< [s]
  std::uint64_t lead_ = 0;         ///< ticks that answers may come before their snapshot
  std::uint64_t lag_ = 0;          ///< ticks of which messages may still be on their way
  ros::SteadyTime changed_at_;     ///< when a snapshot last came or was handled
  ros::SteadyTime began_ = ros::SteadyTime::now();
  ros::SteadyTime stopped_at_;   ///< when the stop signal was seen
  ros::SteadyTime reported_at_;  ///< when this node last said how it stands
  bool final_handled_ = false;
  bool over_ = false;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
};

/// What metrics and recorder have in common: they listen to all answers of a tick and take it when
/// they are complete.
class Observer : public Participant {
 public:
  using Participant::Participant;

 protected:
  bool mayLag() const override { return true; }
  /// Listens to all that the table of channels lists as answers and reports for an observer of this
  /// part; from now on a decision is complete with all that the table asks for.
  void listenToAnswers(Party party, const session::ScenarioOptions& options);
  /// Whether all answers to a tick are here, or nothing more of it will come: in lockstep when it
  /// is `superseded` by a later one.
  bool complete(const ::e2e_cdiff::TrafficSnapshot& snapshot, bool superseded);
  const TickAnswers& answers() const { return answers_; }
  /// Drops the answers to a tick and to those before it.
  void forgetUntil(std::uint64_t tick) { answers_.forgetBefore(tick + 1); }

 private:
  TickAnswers answers_;
  ros::SteadyTime waiting_since_;  ///< for what a decision's record names; zero when not
};

}  // namespace cdiff::node_graph
