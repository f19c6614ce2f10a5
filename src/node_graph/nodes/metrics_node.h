// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "node_graph/lockstep/participant.h"
#include "node_graph/messages/display.h"
#include "node_graph/messages/front_view.h"
#include "node_graph/messages/markers.h"
#include "page/result_writer.h"
#include "video/session_video.h"
#include "watch/live_session.h"

namespace cdiff::node_graph {

/// Metrics as a node: gathers each tick as one record, measures it live, and writes the result
/// folder when the session ends. Shows the session in rviz and in /diagnostics on the side.
class MetricsNode : public Observer {
 public:
  using Observer::Observer;

  /// The ROS master was gone before this node began: writes the result of the session that
  /// roslaunch was asked for, as far as its command line says, and returns the exit code.
  static int runWithoutMaster();

 protected:
  void startSession(const ::e2e_cdiff::SessionInfo& info) override;
  bool handle(const Snapshot& snapshot, bool superseded) override;
  int conclude(Ending ending) override;
  int concludeUnstarted(Ending ending) override;
  std::string subject() const override { return "session"; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override;

 private:
  using Clock = std::chrono::steady_clock;
  void note(const std::vector<session::PlannerLatency>& latencies);
  void advertiseFigures();
  void openPage();
  void show(const session::TickRecord& record);
  void showInRviz(const session::TickRecord& record);
  double wallSeconds() const;
  int finishVideo(int exit_code);

  std::filesystem::path results_;
  std::unique_ptr<session::SessionSetup> setup_;
  std::unique_ptr<page::ResultWriter> writer_;
  std::unique_ptr<video::SessionVideo> video_;  ///< where the scenario asks for it
  std::unique_ptr<watch::LiveSession> live_;    ///< where the launch file asks for it
  std::unique_ptr<MetricReporter> reporter_;
  std::unique_ptr<SessionMarkers> markers_;
  std::unique_ptr<FrontView> front_view_;   ///< once anyone subscribes
  traffic::TrafficSnapshot last_;           ///< last snapshot observed
  std::optional<Clock::time_point> begin_;  ///< first snapshot
  double slowest_planner_ms_ = 0.0;
  std::string slowest_planner_;
  ros::Publisher reports_;
  ros::Publisher marker_output_;
  ros::Publisher map_output_;
  bool map_shown_ = false;
  ros::Publisher view_output_;
  std::map<Topic, ros::Publisher> figures_;  ///< of CBVs
};

}  // namespace cdiff::node_graph
