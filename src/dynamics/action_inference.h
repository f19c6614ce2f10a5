// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The action that the vehicle dynamics needs for a motion: the inverse of BicycleModel over 0.1 s,
/// for recordings that hold no pedals and for planners that choose accelerations (SI units).
#pragma once

#include "e2e_cdiff/dynamics/bicycle_model.h"

namespace cdiff::dynamics {

/// What a vehicle did, or is to do, over 0.1 s.
struct ObservedMotion {
  double speed = 0.0;       ///< at its begin [m/s]
  double next_speed = 0.0;  ///< at its end [m/s]
  double turn = 0.0;        ///< change of heading [rad], positive left
};

/// Throttle or brake, one of them 0, in steps of 0.02, whose speed after 0.1 s is nearest to
/// next_speed; steer from turn = 0.1 s v / l_r sin(slip), 0 below 0.5 m/s; all within range, so
/// that a motion beyond the model's means is approached.
traffic::ControlAction inferAction(const BicycleModel& model, const ObservedMotion& motion);

}  // namespace cdiff::dynamics
