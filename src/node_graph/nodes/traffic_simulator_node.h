// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "diagnostic_updater/diagnostic_updater.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/lockstep/pacer.h"
#include "node_graph/lockstep/participant_tracker.h"
#include "node_graph/lockstep/session_watch.h"
#include "node_graph/messages/display.h"
#include "node_graph/messages/topics.h"
#include "node_graph/nodes/external_cbvs.h"
#include "node_graph/nodes/external_ego.h"
#include "node_graph/nodes/session_services.h"
#include "node_graph/result_reserve.h"
#include "node_graph/session_files.h"
#include "record/result_folder.h"
#include "ros/ros.h"
#include "session/world.h"

namespace cdiff::node_graph {

/// Wall-clock limits [s].
struct SimulatorLimits {
  double start = 30.0;   ///< until every node is connected both ways
  double answer = 30.0;  ///< for the answers to a tick
};

/// The traffic simulator as a node: owns the world and the clock, publishes each tick, and lets the
/// world go on when the session's pacer says so.
class TrafficSimulatorNode {
 public:
  /// Reads the node's parameters and sets the session up. Throws InputError for bad input.
  TrafficSimulatorNode(const Parameters& parameters, StopSignal& stop);

  /// Runs the session to its end and returns the exit code.
  int run();

 private:
  std::unique_ptr<Pacer> makePacer();
  bool startWorld();
  ::e2e_cdiff::SessionInfo sessionInfo(const std::string& simulator_version) const;
  void advertise();
  ros::Publisher advertise(const Topic& topic);
  void listen();
  void listenTo(const Topic& topic);
  std::string takeAnswer(const Topic& topic, const AnyMessage& message);
  std::string takeCommand(const Topic& topic, const AnyMessage& message);
  void noteFault(const std::string& source, const std::string& text);
  bool ofUser(const Topic& topic) const;
  std::optional<SessionEnd> externalPlannerGone() const;
  std::vector<Missing> missingPlanners();
  std::string misdirected();
  std::optional<SessionEnd> waitForParticipants();
  void runTicks();
  std::optional<SessionEnd> waitForAnswers();
  std::optional<SessionEnd> holdBack();
  void publishTick();
  void addTotals(::e2e_cdiff::TrafficSnapshot& message) const;
  std::optional<SessionEnd> advance();
  void endSession(const SessionEnd& end);
  void waitForResult();
  void writeResultAlone();
  void handReserveOver();
  int exitCode() const;
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  StopSignal& stop_;
  ros::NodeHandle node_ = nodeHandle();
  HeartbeatPublisher heartbeat_;
  SimulatorLimits limits_;
  std::filesystem::path results_;
  std::unique_ptr<record::ResultFolder> folder_;  ///< holds it for us and the metrics node
  std::unique_ptr<session::SessionSetup> setup_;
  SessionGraph graph_;
  ParticipantTracker participants_;
  Connections connections_;
  SessionWatch watch_;
  MessageGate gate_;
  std::set<std::string> noted_faults_;  ///< texts
  ros::Publisher clock_;
  ros::Publisher session_;
  ros::Publisher traffic_;
  ros::Publisher route_;
  ros::Publisher records_;
  Display display_;
  std::vector<ros::Subscriber> inputs_;
  std::unique_ptr<ExternalEgo> external_ego_;
  std::unique_ptr<ExternalCbvs> external_cbvs_;
  std::map<Topic, ros::Subscriber> commands_;  ///< of the user's own nodes
  std::string misdirected_;                    ///< commands that nobody listens to
  std::optional<std::chrono::steady_clock::time_point> asked_master_;
  std::unique_ptr<session::World> world_;
  std::unique_ptr<ResultReserve> reserve_;
  std::unique_ptr<Pacer> pacer_;
  std::unique_ptr<SessionServices> services_;
  ::e2e_cdiff::TrafficSnapshot::ConstPtr published_;
  std::size_t steered_ = 0;  ///< changes so far
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
};

/// Runs the session that the node's parameters ask for; bad input is reported in one line, and in
/// the exit code's file where the result folder was given.
int runTrafficSimulator(StopSignal& stop);

}  // namespace cdiff::node_graph
