// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/planning/planner.h"
#include "planners/pdm_lite/pdm_lite_options.h"
#include "planning/route_follower.h"
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

// Grown boxes of forecast vehicles and whether they meet (map frame, 2-D separating axes). Growth
// as published, with i = 0 ... n - 1 the step: ego length x 1.3 and width x 1.2 at a present speed
// of at least 5 m/s; others length x 1.2 (2.0 near a lane change) and width x max(1, 1.3 i / n),
// neither while their forecast speed is below 1 m/s.

/// Boxes of the planned vehicle, one per point of its forecast. The growth follows the speed of
/// now, so a standing vehicle asks for no more room than it takes.
std::vector<geometry::OrientedBox> egoBoxes(const traffic::Vehicle& ego,
                                            const std::vector<planning::RolloutPoint>& forecast);

/// Boxes of another vehicle in the first `steps` of its forecast.
std::vector<geometry::OrientedBox> otherBoxes(const traffic::VehicleDimensions& dimensions,
                                              const std::vector<traffic::VehicleState>& forecast,
                                              std::size_t steps, bool near_lane_change);

/// First index below `steps` at which boxes of the same index overlap.
std::optional<std::size_t> meet(const std::vector<geometry::OrientedBox>& first,
                                const std::vector<geometry::OrientedBox>& second,
                                std::size_t steps);

// What the planned vehicle itself would do if nothing were in its way: its own controllers and
// dynamics along its route toward the initial target speed; one point per 0.1 s (two simulation
// steps of dynamics, for which the polynomials hold: RIFT takes one for 0.1 s, so that the speeds
// that it forecasts change half as fast).

/// Controller state of a vehicle; a copy serves a forecast.
struct DriverState {
  planning::RouteFollower follower;
  LateralController lateral;
};

/// Steer of this decision toward the look-ahead point; updates the driver.
double steerAlong(const map::Route& route, const traffic::VehicleState& state, DriverState& driver);

/// How far the planned vehicle is forecast, and how often its controllers act.
struct EgoHorizon {
  std::size_t steps = 20;  ///< of 0.1 s
  int decisions = 1;       ///< per step: 2 where a decision falls on each simulation step
};

std::vector<planning::RolloutPoint> forecastEgo(const traffic::VehicleState& start,
                                                const map::Route& route, DriverState driver,
                                                double target_speed,
                                                const dynamics::BicycleModel& model,
                                                const EgoHorizon& horizon);

}  // namespace cdiff::planners
