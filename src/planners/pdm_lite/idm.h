// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

namespace cdiff::planners {

// Intelligent driver model as PDM-Lite uses it: the speed [m/s] that a vehicle should have 0.05 s
// from now behind an obstacle, dv/dt = a [1 - (v/v0)^4 - (s*/s)^2], s* = s0 + v T + v (v -
// v_obstacle) / (2 sqrt(a b)), s = max(0.1, d + v_obstacle t - x - L).

/// Constants of the repository version (its report lists others).
struct IdmParameters {
  double acceleration = 24.0;       ///< a [m/s^2]
  double slow_deceleration = 8.7;   ///< b up to slow_speed [m/s^2]
  double fast_deceleration = 3.72;  ///< b above slow_speed [m/s^2]
  double slow_speed = 6.02;         ///< [m/s]
  double time_bound = 0.05;  ///< the speed is that after this time [s], whatever the decision
                             ///< period, as in RIFT at 10 Hz
};

/// What is ahead.
struct IdmObstacle {
  double distance = 0.0;       ///< d: center to center, or along the route to a stop line [m]
  double speed = 0.0;          ///< [m/s]
  double length = 0.0;         ///< L: subtracted from the distance [m]
  double minimum_gap = 4.0;    ///< s0 [m]
  double time_headway = 0.25;  ///< T [s]
};

/// Speed after `time_bound` [m/s], never negative; 0 when `desired_speed` (v0) is not positive.
/// Runge-Kutta of order 4, 10 steps.
double idmSpeed(double speed, double desired_speed, const IdmObstacle& obstacle,
                const IdmParameters& parameters = {});

}  // namespace cdiff::planners
