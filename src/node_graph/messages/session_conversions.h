// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/GuidanceReport.h"
#include "e2e_cdiff/MetricReport.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "metrics/session_metrics.h"
#include "nav_msgs/Path.h"
#include "node_graph/messages/traffic_conversions.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

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
