// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/surrounding_vehicles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace cdiff::planning {
namespace {

struct Neighbour {
  double distance = 0.0;  ///< of the centers [m]
  const traffic::Vehicle* vehicle = nullptr;
};

/// Nearest first, equal distances by id.
std::vector<Neighbour> neighboursOf(const traffic::TrafficSnapshot& snapshot,
                                    const traffic::Vehicle& vehicle, double radius) {
  std::vector<Neighbour> found;
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    if (other.id == vehicle.id || !isFinite(other.state)) continue;
    if (traffic::onDifferentLevels(other, vehicle)) continue;
    const double distance = (other.state.position - vehicle.state.position).norm();
    if (distance < radius) found.push_back({distance, &other});
  }
  std::sort(found.begin(), found.end(), [](const Neighbour& a, const Neighbour& b) {
    return std::tie(a.distance, a.vehicle->id) < std::tie(b.distance, b.vehicle->id);
  });
  return found;
}

}  // namespace

bool isFinite(const traffic::VehicleState& state) {
  return state.position.allFinite() && std::isfinite(state.elevation) &&
         std::isfinite(state.heading) && std::isfinite(state.speed);
}

const traffic::Vehicle* nearestVehicle(const traffic::TrafficSnapshot& snapshot,
                                       const traffic::Vehicle& vehicle) {
  const auto found = neighboursOf(snapshot, vehicle, std::numeric_limits<double>::infinity());
  return found.empty() ? nullptr : found.front().vehicle;
}

std::vector<const traffic::Vehicle*> vehiclesAround(const traffic::TrafficSnapshot& snapshot,
                                                    const traffic::Vehicle& vehicle,
                                                    const traffic::Vehicle* other) {
  constexpr double kRadius = 50.0;  // [m]: two vehicles at 8 m/s close 51 m in 3.2 s
  constexpr std::size_t kMost = 8;
  std::vector<const traffic::Vehicle*> around;
  for (const Neighbour& neighbour : neighboursOf(snapshot, vehicle, kRadius)) {
    if (neighbour.vehicle != other && around.size() < kMost) around.push_back(neighbour.vehicle);
  }
  return around;
}

}  // namespace cdiff::planning
