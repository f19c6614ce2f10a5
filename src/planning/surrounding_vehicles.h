// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planning {

// The vehicles of a snapshot that matter to a plan: on the vehicle's level, with finite states.

bool isFinite(const traffic::VehicleState& state);

/// The vehicle whose center is nearest to that of `vehicle`; nullptr when it is alone.
const traffic::Vehicle* nearestVehicle(const traffic::TrafficSnapshot& snapshot,
                                       const traffic::Vehicle& vehicle);

/// Up to eight vehicles within 50 m but `vehicle` and `other`, nearest first.
std::vector<const traffic::Vehicle*> vehiclesAround(const traffic::TrafficSnapshot& snapshot,
                                                    const traffic::Vehicle& vehicle,
                                                    const traffic::Vehicle* other);

}  // namespace cdiff::planning
