// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Gates that a vehicle passes before conflicts are searched: near the ego, on its level, and
/// properly on a lane (RIFT's rules 2 to 4).
#pragma once

#include <optional>

#include "cbv/cbv_options.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "map/lane_graph.h"

namespace cdiff::cbv {

/// Where a vehicle is among the lanes; `reason` is null when it stands properly on one.
struct LanePlacement {
  const char* reason = nullptr;
  map::LanePosition place;
};

/// The point that must lie on a lane, `distance` [m] ahead of a vehicle's centre, map frame [m].
inline Eigen::Vector2d previewPoint(const traffic::VehicleState& state, double distance) {
  return state.position + distance * geometry::direction(state.heading);
}

/// First gate of nearness and level that `vehicle` fails, or nullptr.
const char* failedNearness(const traffic::Vehicle& vehicle, const traffic::Vehicle& ego,
                           const CbvOptions& options);

/// The vehicle's own lane: the one SUMO names when its centre lies there, else the nearest of its
/// direction. The preview point must lie on a lane, and inside a junction along one.
LanePlacement placeOnLane(const map::RoadNetwork& network, const traffic::Vehicle& vehicle,
                          const CbvOptions& options);

}  // namespace cdiff::cbv
