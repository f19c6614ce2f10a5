// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>

#include "e2e_cdiff/geometry/pose.h"
#include "planners/pdm_lite/pdm_lite_options.h"

namespace cdiff::planners {

/// Distance along the route of the point that is aimed at [m]: 2.4 up to 6.3 m/s, 3.0 at 8 m/s, at
/// most 10.5. The published route has points every 0.1 m; the distance is a whole number of those.
double lookAheadDistance(double speed);

/// PDM-Lite's steering: PID on the bearing of a route point ahead relative to the vehicle's
/// heading, in units of 90 degrees; steer [-1, 1], positive left. One call per decision (the gains
/// are per call, so they depend on the decision period).
/// Copyable: a copy steers a forecast without touching the original.
class LateralController {
 public:
  explicit LateralController(const PdmLiteOptions& options = {});
  /// Steer towards `aim` (map frame); remembers the error. Output rounded to 3 decimals.
  double steer(const geometry::Pose2d& pose, const Eigen::Vector2d& aim);

 private:
  double kp_;
  double ki_;
  double kd_;
  std::deque<double> errors_;  ///< newest last, of fixed length, zeros at the start
};

// PDM-Lite's throttle and brake from speed and target speed [m/s]: full throttle far below the
// target, full brake above 1.0313 x the target, else a regression in c = v / (100 km/h) and e =
// max(target - v, 0) / (100 km/h). Without state.

struct PedalCommand {
  double throttle = 0.0;  ///< [0, 1]
  bool brake = false;     ///< full brake
};

/// Pedals for a target; brakes when the target is below 1e-5 m/s, raises any other target to 1
/// km/h.
PedalCommand pedals(double speed, double target_speed);

/// Throttle of the ego forecast, which never brakes.
double forecastThrottle(double speed, double target_speed);

}  // namespace cdiff::planners
