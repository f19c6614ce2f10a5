// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/dynamics/bicycle_model.h"

namespace cdiff::dynamics {

// From pedals to accelerations and back, for planners that choose accelerations;
// e2e_cdiff.pedal_map is the same in Python. Steer stays 0.

/// Acceleration that throttle and brake of an action give at `speed` [m/s] over the next 0.05 s
/// [m/s^2].
double accelerationOf(const BicycleModel& model, double speed,
                      const traffic::ControlAction& action);

/// The pedal, one of the two, whose acceleration at `speed` [m/s] is nearest to `acceleration`
/// [m/s^2]. Negative ones brake, exactly down to full braking; at standstill they brake fully. From
/// 0 to the least acceleration of a throttle of 0.3, the nearer of the two; beyond the largest, the
/// throttle that gives that. Throws std::invalid_argument unless both are finite and the speed is
/// not negative.
traffic::ControlAction pedalsFor(const BicycleModel& model, double speed, double acceleration);

/// The largest curvature of the path of the vehicle's center [1/m], at steer = 1.
double largestCurvature(const BicycleModel& model);

/// The steer whose path of the center has this curvature [1/m], positive left. Throws
/// std::invalid_argument for one that is not finite or above largestCurvature.
double steerFor(const BicycleModel& model, double curvature);

}  // namespace cdiff::dynamics
