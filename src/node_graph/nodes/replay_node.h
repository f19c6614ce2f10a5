// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "node_graph/bags/recorded_session.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/lockstep/participant_tracker.h"
#include "node_graph/messages/display.h"
#include "node_graph/session_files.h"
#include "record/result_folder.h"
#include "ros/ros.h"

namespace cdiff::node_graph {

/// A recorded session replayed on its topics, in the place of the traffic simulator: it publishes
/// the bag's ticks and the answers to each, and waits for the metrics node's acknowledgement of a
/// tick before the next. So the metrics node sees what it saw live, and nothing can be lost on the
/// way.
class ReplayNode {
 public:
  /// Parameters: bag, results (empty: a folder of its own in HOME), rate (times real time; 0: as
  /// fast as the metrics node can), folder (relative paths are meant from here). Throws InputError
  /// for bad input.
  ReplayNode(const Parameters& parameters, StopSignal& stop);

  /// Replays the session to its end; returns 0, 2 for a damaged recording or a metrics node that
  /// failed, 130 when interrupted.
  int run();

 private:
  using Clock = std::chrono::steady_clock;
  void advertise();
  void publishSession();
  void publishTick(const ::e2e_cdiff::TrafficSnapshot::ConstPtr& snapshot);
  void publishAnswers(const ::e2e_cdiff::TrafficSnapshot& snapshot);
  void publishPlans(const ::e2e_cdiff::TrafficSnapshot& snapshot);
  void waitUntilDue(double time);
  void replayTicks();
  void publishInterruption();
  bool waitForMetrics(const ::e2e_cdiff::TrafficSnapshot& snapshot);
  std::vector<std::string> notReady() const;
  /// False when the session cannot go on.
  bool waitFor(const std::function<std::vector<std::string>()>& missing);
  bool disturbed();
  int finish();
  void offer(const Topic& topic);

  StopSignal& stop_;
  double rate_ = 1.0;
  std::filesystem::path bag_;
  std::filesystem::path results_;
  std::unique_ptr<record::ResultFolder> folder_;  ///< holds it for us and the metrics node
  RecordedSession session_;
  SessionGraph graph_;  ///< of the replay: without recorder
  ParticipantTracker participants_;
  MessageGate gate_;
  Connections connections_;
  ros::NodeHandle node_;
  HeartbeatPublisher heartbeat_;
  std::map<Topic, ros::Publisher> topics_;
  ros::Subscriber acks_;
  std::vector<ros::ServiceServer> refusals_;  ///< of those who would steer it
  Display display_;
  ::e2e_cdiff::TrafficSnapshot::ConstPtr last_;  ///< published
  Clock::time_point begin_;
  bool failed_ = false;
};

/// Replays the bag that the node's parameters name; bad input is reported in one line, and in the
/// exit code's file where the result folder was given.
int runReplay(StopSignal& stop);

}  // namespace cdiff::node_graph
