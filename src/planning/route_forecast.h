// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Where a vehicle whose route is known will be (map frame, SI units): along the route at its
/// present lateral offset, with its present acceleration for one second and constant speed
/// afterwards.
#pragma once

#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::planning {

/// States 0.1, 0.2 ... steps x 0.1 s from now; `arc_length` is the vehicle's place on the route.
std::vector<traffic::VehicleState> forecastAlongRoute(const traffic::Vehicle& vehicle,
                                                      const map::Route& route, double arc_length,
                                                      std::size_t steps);

}  // namespace cdiff::planning
