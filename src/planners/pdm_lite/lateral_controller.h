// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/geometry/shapes.h"
#include "planners/pdm_lite/pdm_lite_options.h"
#include "planning/windowed_pid.h"

namespace cdiff::planners {

/// Distance along the route of the point that is aimed at [m]: 2.4 up to 6.3 m/s, 3.0 at 8 m/s, at
/// most 10.5. The published route has points every 0.1 m; the distance is a whole number of those.
double lookAheadDistance(double speed);

/// PDM-Lite's steering: PID on the bearing of a route point ahead relative to the vehicle's
/// heading, in units of 90 degrees; steer [-1, 1], positive left. One call per decision.
/// Copyable: a copy steers a forecast without touching the original.
class LateralController {
 public:
  explicit LateralController(const PdmLiteOptions& options = {});
  /// Steer toward `aim` (map frame); remembers the error. Output rounded to 3 decimals.
  double steer(const geometry::Pose2d& pose, const Eigen::Vector2d& aim);

 private:
  planning::WindowedPid pid_;
};

}  // namespace cdiff::planners
