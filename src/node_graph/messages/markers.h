// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "session/session_setup.h"
#include "visualization_msgs/MarkerArray.h"

namespace cdiff::node_graph {

/// Lane borders, junction outlines and the ego's route; starts with DELETEALL. Stays until the
/// session ends.
visualization_msgs::MarkerArray mapMarkers(const session::SessionSetup& setup);

/// The planned rollouts of CBVs, one line each by slot, and in mode challenging the ghosts of their
/// promises with the last moment to brake; lives for 0.5 s of simulated time.
visualization_msgs::MarkerArray rolloutMarkers(const std::vector<planning::PlannedAction>& actions,
                                               double time);

/// What a planner believes to see: boxes of vehicles, as opaque as their scores, the most probable
/// way of each, lines of the road by kind, and the cells that are occupied more probably than not,
/// the later the fainter. `elevation`: of the road [m]. Starts with DELETEALL; lives for 0.5 s of
/// simulated time.
visualization_msgs::MarkerArray perceptionMarkers(const planning::Perception& perception,
                                                  double elevation, double time);

/// The session as rviz markers in `map`: the network and the ego's route once, then vehicles by
/// role (ego red, CBV purple, background blue), conflict points and conflict-aware routes.
/// One per session: gives each vehicle an id that it keeps.
class SessionMarkers {
 public:
  /// Vehicles of a snapshot; conflict points and routes when there is a selection. Each lives for
  /// 0.5 s of simulated time, so what is not sent again vanishes. The first starts with DELETEALL.
  visualization_msgs::MarkerArray build(const traffic::TrafficSnapshot& snapshot,
                                        const cbv::CbvSelection* selection);

 private:
  int idOf(const std::string& vehicle_id);
  std::map<std::string, int> ids_;
  bool first_ = true;
};

}  // namespace cdiff::node_graph
