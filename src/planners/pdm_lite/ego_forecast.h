// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the planned vehicle itself would do if nothing were in its way: its own controllers and
/// dynamics along its route towards the initial target speed; one point per 0.1 s (two simulation
/// steps of dynamics, for which the polynomials hold).
#pragma once

#include <vector>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/planning/planner.h"
#include "planners/pdm_lite/lateral_controller.h"
#include "planning/route_follower.h"

namespace cdiff::planners {

/// Controller state of a vehicle; a copy serves a forecast.
struct DriverState {
  planning::RouteFollower follower;
  LateralController lateral;
};

/// Steer of this decision towards the look-ahead point; updates the driver.
double steerAlong(const map::Route& route, const traffic::VehicleState& state, DriverState& driver);

std::vector<planning::RolloutPoint> forecastEgo(const traffic::VehicleState& start,
                                                const map::Route& route, DriverState driver,
                                                double target_speed,
                                                const dynamics::BicycleModel& model,
                                                std::size_t steps);

}  // namespace cdiff::planners
