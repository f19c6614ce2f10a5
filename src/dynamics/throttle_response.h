// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/dynamics/bicycle_model.h"

namespace cdiff::dynamics {

// The fitted response to the throttle is not monotone: u < 0.3 leaves the speed v as it is, u from
// 0.3 up to u_0(v) (0.40 at 4 m/s, 0.45 at 8 m/s) slows the car, u above u_0(v) drives it.

/// What the pedals of an executed action do to a vehicle at its speed, by the change of
/// BicycleModel::nextSpeed [m/s] against that without a pedal.
enum class PedalUse {
  kBraking,   ///< the brake acts
  kCoasting,  ///< no change: throttle below 0.3
  kNotch,     ///< the throttle slows the car: u in [0.3, u_0(v))
  kDriving    ///< the throttle drives it: u above u_0(v)
};

/// At `speed` [m/s]; of an action with both pedals the brake counts.
PedalUse pedalUse(const BicycleModel& model, double speed, const traffic::ControlAction& action);

/// How a planner's throttle is executed: as BicycleModel's fit responds to it, or monotone:
/// acceleration max(0, fit(v, u)), which is continuous in u at u_0(v).
enum class ThrottleResponse { kFitted, kMonotone };

/// "fitted" or "monotone"; throws std::invalid_argument for another text.
ThrottleResponse throttleResponse(const std::string& name);

/// The action to command at `speed` [m/s] for a response: with the monotone one a throttle that
/// would slow the car becomes 0, which leaves its speed. All else stays.
traffic::ControlAction commandedAction(const BicycleModel& model, ThrottleResponse response,
                                       double speed, const traffic::ControlAction& action);

}  // namespace cdiff::dynamics
