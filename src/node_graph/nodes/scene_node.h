// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/Rollout.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/messages/front_view.h"
#include "node_graph/messages/markers.h"
#include "ros/ros.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

/// Shows in rviz what `rosbag play` of a session's bag publishes: makes the markers that the
/// metrics node makes while a session runs. No session waits for it.
class SceneNode {
 public:
  explicit SceneNode(StopSignal& stop) : stop_(stop) {}
  /// Until a stop signal; returns the exit code.
  int run();

 private:
  void takeSession(const ::e2e_cdiff::SessionInfo& info);
  void takeSelection(const ::e2e_cdiff::CbvSelection::ConstPtr& selection);
  void takeTraffic(const ::e2e_cdiff::TrafficSnapshot& snapshot);
  void takeRollout(const ::e2e_cdiff::Rollout& message);
  void show();
  void listenToRollouts();

  StopSignal& stop_;
  ros::NodeHandle node_;
  ros::Publisher markers_output_;
  ros::Publisher map_output_;
  ros::Publisher rollouts_output_;
  ros::Publisher view_output_;
  std::vector<ros::Subscriber> rollouts_;  ///< of the session's slots
  std::unique_ptr<session::SessionSetup> setup_;
  std::unique_ptr<SessionMarkers> markers_;
  std::unique_ptr<FrontView> front_view_;
  traffic::TrafficSnapshot last_;                  ///< the last snapshot
  std::map<int, planning::PlannedAction> plans_;   ///< the last one of each slot
  ::e2e_cdiff::CbvSelection::ConstPtr selection_;  ///< the last one
};

}  // namespace cdiff::node_graph
