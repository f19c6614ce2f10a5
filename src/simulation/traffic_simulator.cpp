// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/traffic_simulator.h"

#include <algorithm>

namespace cdiff::simulation {

const SimulatedVehicle* findVehicle(const std::vector<SimulatedVehicle>& vehicles,
                                    const std::string& id) {
  const auto found = std::lower_bound(
      vehicles.begin(), vehicles.end(), id,
      [](const SimulatedVehicle& vehicle, const std::string& key) { return vehicle.id < key; });
  return found != vehicles.end() && found->id == id ? &*found : nullptr;
}

traffic::Vehicle asBackground(const SimulatedVehicle& simulated) {
  traffic::Vehicle vehicle;
  vehicle.id = simulated.id;
  vehicle.state = simulated.state;
  vehicle.dimensions = simulated.dimensions;
  vehicle.acceleration = simulated.acceleration;
  vehicle.lane_id = simulated.lane_id;
  return vehicle;
}

}  // namespace cdiff::simulation
