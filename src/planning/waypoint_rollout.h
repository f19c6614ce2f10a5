// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/planning/planner.h"

namespace cdiff::planning {

/// The straight lines from waypoint to waypoint (body frame of `start`, `period` apart, the first
/// one that far ahead) as states 0.1 s apart, in the map frame, each with `action`.
std::vector<RolloutPoint> rolloutAlong(const traffic::VehicleState& start,
                                       const std::vector<Eigen::Vector2d>& waypoints, double period,
                                       const traffic::ControlAction& action);

}  // namespace cdiff::planning
