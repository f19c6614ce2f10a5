// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>

#include "e2e_cdiff/traffic/vehicle.h"
#include "planners/pdm_lite/lateral_controller.h"

namespace cdiff::planners {

inline constexpr const char* kPdmLiteTracker = "pdm_lite";

/// Makes one vehicle follow a plan (its body frame, m, one place per 0.1 s) with PDM-Lite's
/// controllers, in its configuration `rift`: LateralController toward the point lookAheadDistance
/// along the line through the vehicle and the planned places (the last place if the plan is
/// shorter), pedals for the plan's desired speed. It steers whenever it moves, but toward nothing
/// nearer than PlanTracker::kNearestAim. One call per decision (every 0.1 s).
class PdmLiteTracker {
 public:
  /// `speed_horizon`: part of the plan over which the desired speed is a mean [s].
  explicit PdmLiteTracker(double speed_horizon) : speed_horizon_(speed_horizon) {}
  /// Action at `speed` [m/s] for `places` [T, 2], as PlanTracker::track.
  traffic::ControlAction track(double speed, const Eigen::MatrixX2d& places);

 private:
  double speed_horizon_;
  LateralController lateral_;
};

/// The point `distance` meters along the line from the origin through `places`, the last place if
/// the line is shorter.
Eigen::Vector2d pointAlong(const Eigen::MatrixX2d& places, double distance);

}  // namespace cdiff::planners
