// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/planning/planner.h"
#include "node_graph/messages/marker_parts.h"
#include "visualization_msgs/MarkerArray.h"

namespace cdiff::node_graph {

/// The color of a guidance objective, by its place in the table of objectives; that of a plan that
/// none guided for an empty name.
MarkerColor objectiveColor(const std::string& objective);

/// The objective that pulled hardest at a plan (the largest mean gradient); empty where none did.
std::string strongestObjective(const guidance::GuidanceReport& report);

/// That of a vehicle's plan: of the strongest objective of a CBV's, orange of the ego's.
MarkerColor planColor(const planning::PlannedAction& action);

/// "plan of bg_7: 7.9 m/s in 3.2 s, pulled by collision_seeking"; the action has a rollout.
std::string intentionText(const planning::PlannedAction& action);

/// In mode challenging whether it attacks, why it withdrew, and the last moment to brake; else
/// empty.
std::string challengeText(const planning::PlannedAction& action);

/// What vehicles intend, by slot: the rollout as a broad line in the plan's color with a dot per
/// second; the plans that it was chosen from as thin lines, the better the brighter; whom the
/// planner looked at; in mode challenging the ghosts of promises. `snapshot`: that of the decision.
/// Lives for 0.5 s of simulated time.
visualization_msgs::MarkerArray planMarkers(const std::vector<planning::PlannedAction>& actions,
                                            const traffic::TrafficSnapshot& snapshot);

/// What a planner believes to see: boxes of vehicles, as opaque as their scores, the most probable
/// way of each, lines of the road by kind, and the cells that are occupied more probably than not,
/// the later the fainter. `elevation`: of the road [m]. Starts with DELETEALL; lives for 0.5 s of
/// simulated time.
visualization_msgs::MarkerArray perceptionMarkers(const planning::Perception& perception,
                                                  double elevation, double time);

}  // namespace cdiff::node_graph
