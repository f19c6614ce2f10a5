// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::planning {

// The vehicles of a snapshot that matter to a plan: on the vehicle's level, with finite states.

bool isFinite(const traffic::VehicleState& state);
/// Why a vehicle cannot be driven along its route: its state is not finite, or it has no route;
/// empty where it can.
std::string faultOf(const PlanningTask& task);
/// The same, and also a vehicle of the snapshot whose state is not finite: for planners that look
/// at all of them.
std::string faultOf(const traffic::TrafficSnapshot& snapshot, const PlanningTask& task);

/// The vehicle whose center is nearest to that of `vehicle`; nullptr when it is alone.
const traffic::Vehicle* nearestVehicle(const traffic::TrafficSnapshot& snapshot,
                                       const traffic::Vehicle& vehicle);

/// Up to eight vehicles within 50 m but `vehicle` and `other`, nearest first.
std::vector<const traffic::Vehicle*> vehiclesAround(const traffic::TrafficSnapshot& snapshot,
                                                    const traffic::Vehicle& vehicle,
                                                    const traffic::Vehicle* other);

/// Where other vehicles will be (map frame, SI units): one state per 0.1 s from now on.
///  - A vehicle with an applied action holds it, as published: bicycle, with dv/dt = 0.5633837
///    throttle (1 - brake) - 4.952399 brake, v >= 0.
///  - A vehicle that SUMO drives has no pedals. It follows the centerline of its lane at its
///    present lateral offset and goes on into the lane that follows if there is only one, else into
///    the one straight on, else along its heading: the published constant steer would leave the
///    lane at each change of curvature. Its acceleration is held, limited to
///    [-4.952399, 3] m/s^2, its speed to [0, the lane's limit or its present speed].
///  - Off the lanes (farther than 2.5 m, or more than 60 degrees across): present yaw rate and
///    acceleration held.
inline constexpr double kForecastStep = 0.1;  ///< [s]

/// States 0.1, 0.2 ... steps x 0.1 s from now.
std::vector<traffic::VehicleState> forecastMotion(const traffic::Vehicle& vehicle,
                                                  const map::RoadNetwork& network,
                                                  const dynamics::BicycleModelOptions& bicycle,
                                                  std::size_t steps);

// Where a vehicle whose route is known will be (map frame, SI units): along the route at its
// present lateral offset, with its present acceleration for one second and constant speed
// afterward.

/// States 0.1, 0.2 ... steps x 0.1 s from now; `arc_length` is the vehicle's place on the route.
std::vector<traffic::VehicleState> forecastAlongRoute(const traffic::Vehicle& vehicle,
                                                      const map::Route& route, double arc_length,
                                                      std::size_t steps);

}  // namespace cdiff::planning
