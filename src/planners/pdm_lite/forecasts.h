// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/planning/planner.h"
#include "planners/pdm_lite/lateral_controller.h"
#include "planning/route_follower.h"

namespace cdiff::planners {

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
