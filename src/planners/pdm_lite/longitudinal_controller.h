// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

namespace cdiff::planners {

// PDM-Lite's throttle and brake from speed and target speed [m/s]: full throttle far below the
// target, full brake above 1.0313 x the target, else a regression in c = v / (100 km/h) and e =
// max(target - v, 0) / (100 km/h). Without state.

/// Pedals that a longitudinal controller asks for.
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
