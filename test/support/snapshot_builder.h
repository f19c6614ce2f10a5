// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Snapshots written in a test: an ego and background vehicles, by position, heading and speed.
#pragma once

#include <string>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::test {

/// Where a vehicle of a test is.
struct Motion {
  double x = 0.0;        ///< [m]
  double y = 0.0;        ///< [m]
  double heading = 0.0;  ///< [deg]
  double speed = 0.0;    ///< [m/s]
  double z = 0.0;        ///< [m]
};

inline traffic::Vehicle vehicle(const std::string& id, const Motion& motion,
                                traffic::VehicleRole role = traffic::VehicleRole::kBackground) {
  traffic::Vehicle vehicle;
  vehicle.id = id;
  vehicle.role = role;
  vehicle.state.position = {motion.x, motion.y};
  vehicle.state.elevation = motion.z;
  vehicle.state.heading = core::degreesToRadians(motion.heading);
  vehicle.state.speed = motion.speed;
  return vehicle;
}

/// A decision at tick x 0.05 s with the ego alone.
inline traffic::TrafficSnapshot snapshotWithEgo(std::uint64_t tick, const Motion& ego) {
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = tick;
  snapshot.time = 0.05 * static_cast<double>(tick);
  snapshot.decision_tick = true;
  snapshot.vehicles.push_back(vehicle("ego", ego, traffic::VehicleRole::kEgo));
  return snapshot;
}

}  // namespace cdiff::test
