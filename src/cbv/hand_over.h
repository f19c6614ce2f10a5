// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::cbv {

// Whether a vehicle can be handed over: what touches another vehicle at once was not caused by the
// planner that takes it.

/// Where a vehicle goes if it drives on at its speed: along a path, else straight on.
struct Motion {
  traffic::Vehicle vehicle;                  ///< now
  const geometry::Polyline* path = nullptr;  ///< nullptr: straight on
  double arc_length = 0.0;                   ///< on the path, now [m]

  /// Its box after `time` [s] with this deceleration [m/s^2] until it stands.
  geometry::OrientedBox boxAfter(double time, double deceleration = 0.0) const;
};

/// Whether the vehicle that is to be handed over overlaps one of the others on its level within
/// `time` [s], looked at every 0.1 s, if it keeps its speed or if it brakes by 4 m/s^2.
bool contactAhead(const Motion& handed_over, const std::vector<Motion>& others, double time);

}  // namespace cdiff::cbv
