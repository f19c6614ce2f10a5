// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/GuidanceReport.h"
#include "e2e_cdiff/MetricReport.h"
#include "e2e_cdiff/Rollout.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "metrics/session_metrics.h"
#include "nav_msgs/Path.h"
#include "ros/time.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

// Ticks of messages that carry a stamp alone.

/// Tick whose stamp is nearest; `simulation_step` in [s].
std::uint64_t nearestTick(const ros::Time& stamp, double simulation_step);

// Between the core's value types and our messages, exact for every float64: `fromMsg(toMsg(x))` is
// x, bit by bit.

namespace msgs = ::e2e_cdiff;

/// Frame of every position in our messages.
inline constexpr const char* kMapFrame = "map";

/// Simulated time as a ROS stamp.
ros::Time toStamp(double seconds);

msgs::VehicleState toMsg(const traffic::VehicleState& state);
traffic::VehicleState fromMsg(const msgs::VehicleState& message);
msgs::Vehicle toMsg(const traffic::Vehicle& vehicle);
/// Throws InputError for an unknown role.
traffic::Vehicle fromMsg(const msgs::Vehicle& message);
msgs::TrafficSnapshot toMsg(const traffic::TrafficSnapshot& snapshot);
/// Throws InputError for an unknown status.
traffic::TrafficSnapshot fromMsg(const msgs::TrafficSnapshot& message);

msgs::Perception toMsg(const planning::Perception& perception);
/// Without occupancy whose cells are not rows x columns.
planning::Perception fromMsg(const msgs::Perception& message);

/// How an action came about.
struct ActionOrigin {
  std::string planner;      ///< "ego:NAME" or "cbv:NAME"
  double latency_ms = 0.0;  ///< wall time of the planning call [ms]
  std::string fault;        ///< empty when none
};

/// `snapshot` gives tick and stamp. The fault is the planning call's, else the action's own.
msgs::ControlAction toMsg(const planning::PlannedAction& action,
                          const traffic::TrafficSnapshot& snapshot, const ActionOrigin& origin);
/// Without rollout and guidance, which have messages of their own.
planning::PlannedAction fromMsg(const msgs::ControlAction& message);
msgs::Rollout toRolloutMsg(const planning::PlannedAction& action,
                           const traffic::TrafficSnapshot& snapshot);
std::vector<planning::RolloutPoint> fromMsg(const msgs::Rollout& message);
std::vector<planning::PlannedCandidate> candidatesFromMsg(const msgs::Rollout& message);

/// What guidance did for all vehicles of a decision; the caller fills in latency and image age.
msgs::GuidanceReport toGuidanceMsg(const std::vector<planning::PlannedAction>& actions,
                                   const traffic::TrafficSnapshot& snapshot);
guidance::GuidanceReport fromMsg(const msgs::VehicleGuidance& message);

/// Names lanes by their ids in `network`.
msgs::CbvSelection toMsg(const cbv::CbvSelection& selection, double time,
                         const map::RoadNetwork& network);
/// Throws InputError for a lane that `network` does not have.
cbv::CbvSelection fromMsg(const msgs::CbvSelection& message, const map::RoadNetwork& network);

/// The scenario, the network and the ego route; the caller fills in the rest.
msgs::SessionInfo toMsg(const session::SessionSetup& setup);
/// Options of the session. Throws InputError when they cannot be read.
session::ScenarioOptions optionsFromMsg(const msgs::SessionInfo& message);
map::ImportedNetwork importFromMsg(const msgs::SessionInfo& message);
std::vector<Eigen::Vector3d> routeFromMsg(const msgs::SessionInfo& message);

/// Positions are exact; orientations are for display.
nav_msgs::Path toPathMsg(const map::Route& route);
std::vector<Eigen::Vector3d> fromMsg(const nav_msgs::Path& message);

msgs::MetricReport toMsg(const metrics::TickMeasures& measures,
                         const traffic::TrafficSnapshot& snapshot);
/// All measures of a session, in a fixed order.
std::vector<msgs::Measure> toMsg(const metrics::SessionMeasures& measures);

}  // namespace cdiff::node_graph
