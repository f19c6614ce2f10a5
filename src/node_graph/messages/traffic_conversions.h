// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/Rollout.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "ros/time.h"

namespace cdiff::node_graph {

// Ticks of messages that carry a stamp alone.

/// Tick whose stamp is nearest; `simulation_step` in [s].
std::uint64_t nearestTick(const ros::Time& stamp, double simulation_step);

// Between the core's value types and our messages, exact for every float64: `fromMsg(toMsg(x))` is
// x, bit by bit.

namespace msgs = ::e2e_cdiff;

/// Frame of every position in our messages, where a session runs in no namespace.
inline constexpr const char* kMapFrame = "map";
/// A frame as this process publishes it: in the namespace /a with the prefix "a/", so that sessions
/// share one tf.
std::string frameId(const std::string& frame);

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

std::vector<traffic::SteeringChange> fromMsg(const std::vector<msgs::SteeringChange>& changes);

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

}  // namespace cdiff::node_graph
