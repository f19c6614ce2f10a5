// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "node_graph/lockstep/decision_tracker.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/lockstep/paced_answers.h"
#include "node_graph/lockstep/participant_tracker.h"
#include "node_graph/lockstep/tick_answers.h"
#include "node_graph/messages/display.h"
#include "node_graph/messages/topics.h"
#include "node_graph/session_files.h"
#include "ros/ros.h"
#include "session/world.h"

namespace cdiff::node_graph {

/// Wall-clock limits [s].
struct SimulatorLimits {
  double start = 30.0;   ///< until every node is connected both ways
  double answer = 30.0;  ///< for the answers to a tick
};

/// The traffic simulator as a node: owns the world and the clock, publishes each tick and waits for
/// every answer and acknowledgement that the tick needs before the world goes on.
class TrafficSimulatorNode {
 public:
  /// Reads the node's parameters and sets the session up. Throws InputError for bad input.
  TrafficSimulatorNode(const Parameters& parameters, StopSignal& stop);

  /// Runs the session to its end and returns the exit code.
  int run();

 private:
  /// Why a session ends from outside.
  struct Ending {
    traffic::SessionStatus status;
    traffic::Fault fault;
  };
  /// What a tick still lacks.
  struct Missing {
    std::string node;  ///< who owes it
    std::string what;
  };
  using MissingNow = std::function<std::vector<Missing>()>;
  using Clock = std::chrono::steady_clock;

  bool startWorld();
  void advertise();
  void listen();
  ros::Publisher advertise(const Topic& topic);
  void listenTo(const Topic& topic);
  std::string takeAnswer(const Topic& topic, const AnyMessage& message);
  void noteFault(const std::string& source, const std::string& text);
  void publishSession();
  std::optional<Ending> waitForParticipants();
  void runTicks();
  void publishTick();
  void addTotals(::e2e_cdiff::TrafficSnapshot& message) const;
  std::optional<Ending> waitForTick();
  std::optional<Ending> waitUntilDue();
  std::optional<Ending> sleepUntil(double due);
  std::optional<Ending> waitFor(const MissingNow& missing_now, double seconds);
  std::optional<Ending> disturbance();
  bool egoGone() const;
  Ending endOfPatience(const std::vector<Missing>& missing, double seconds);
  void endSession(const Ending& ending);
  Ending ending(traffic::SessionStatus status, const std::string& source,
                const std::string& text) const;
  void advance();
  void advancePaced();
  void recordFaults(const std::vector<Answer>& answers);
  void publishRecord(const ::e2e_cdiff::DecisionRecord::ConstPtr& record);
  void closeDecisions();
  void settleDecisions(bool all);
  void keepSettledInReserve();
  void forgetSettled();
  bool waitsForRollout(const Topic& topic, const AnyMessage& message);
  void noteArrival(int slot, std::uint64_t tick);
  void waitForObservers();
  void writeResultAlone(const traffic::TrafficSnapshot& snapshot);
  std::unique_ptr<ReserveResult> makeReserve(const std::string& version) const;
  void keepInReserve(const cbv::CbvSelection* selection,
                     const std::vector<planning::PlannedAction>& actions,
                     const std::vector<Answer>& answers);
  int exitCode() const;
  std::vector<Missing> missingParticipants() const;
  std::vector<Missing> missingAnswers() const;
  std::vector<Missing> missingAtTick() const;
  std::vector<Missing> silentFor(double seconds) const;
  bool standsPerhapsForSilence() const;
  void sendAgainForLateListener();
  bool paced() const { return setup_->options().real_time_factor > 0.0; }

  StopSignal& stop_;
  ros::NodeHandle node_;
  HeartbeatPublisher heartbeat_;
  SimulatorLimits limits_;
  std::filesystem::path results_;
  std::unique_ptr<record::ResultFolder> folder_;  ///< holds it for us and the metrics node
  std::unique_ptr<session::SessionSetup> setup_;
  SessionGraph graph_;
  ParticipantTracker book_;
  TickAnswers answers_;
  PacedAnswers paced_answers_;
  std::map<int, AnyMessage> early_controls_;  ///< by slot: come before their rollouts
  std::optional<DecisionTracker>
      decisions_;         ///< set by the constructor; used where answers may be late
  bool recorded_ = true;  ///< whether the record of the current decision was published
  std::set<std::string> late_planners_;  ///< whose first late answer is recorded as a fault
  std::deque<::e2e_cdiff::TrafficSnapshot::ConstPtr> unsettled_;  ///< from an open decision on
  MessageGate gate_;
  std::set<std::string> noted_faults_;  ///< texts
  Connections connections_;
  ros::Publisher clock_;
  ros::Publisher session_;
  ros::Publisher traffic_;
  ros::Publisher route_;
  ros::Publisher records_;
  Display display_;
  std::vector<ros::Subscriber> inputs_;
  ros::Subscriber ego_control_;
  Clock::time_point ego_heard_at_;  ///< last command of the external ego
  std::set<std::string> blamed_;    ///< nodes that are not waited for any more
  std::unique_ptr<session::World> world_;
  std::unique_ptr<ReserveResult> reserve_;
  ::e2e_cdiff::TrafficSnapshot::ConstPtr published_;
  Clock::time_point begin_;
  Clock::time_point published_at_;
  Clock::time_point acknowledged_at_;  ///< last time that the observers came on
  std::uint64_t acknowledged_ = 0;     ///< tick that all of them had acknowledged then
};

/// Runs the session that the node's parameters ask for; bad input is reported in one line, and in
/// the exit code's file where the result folder was given.
int runTrafficSimulator(StopSignal& stop);

}  // namespace cdiff::node_graph
