// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "map/lane_graph.h"

namespace cdiff::map {

// Turns driven stretches of lanes into a route: points about 1 m apart on the centerlines (map
// frame [m]), lane changes blended with w(t) = 3 t^2 - 2 t^3.

/// The part of a lane that is driven; the next stretch follows the lane or lies on its neighbor (a
/// lane change at `end`).
struct LaneStretch {
  LaneIndex lane = kNoLane;
  double begin = 0.0;  ///< arc length [m]
  double end = 0.0;    ///< arc length [m]
};

/// Whether a link leads from one lane to the other.
bool follows(const RoadNetwork& network, LaneIndex from, LaneIndex to);

/// Adds a route from `start` on its first lane to `goal` on its last; the route goes on where
/// `drive` ends. Lane changes lie in the middle of the first 60 m that the route has for them.
void appendPath(const RoadNetwork& network, const LanePath& path, double start, double goal,
                std::vector<LaneStretch>& drive);

/// Throws InputError when the route is shorter than 1 cm.
Route buildRoute(const RoadNetwork& network, const std::vector<LaneStretch>& drive);

}  // namespace cdiff::map
