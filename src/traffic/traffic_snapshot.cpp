// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/traffic/traffic_snapshot.h"

#include <algorithm>

namespace cdiff::traffic {
namespace {

template <class Predicate>
const Vehicle* findVehicle(const std::vector<Vehicle>& vehicles, Predicate predicate) {
  const auto found = std::find_if(vehicles.begin(), vehicles.end(), predicate);
  return found == vehicles.end() ? nullptr : &*found;
}

}  // namespace

const char* toText(SessionStatus status) {
  constexpr const char* kTexts[] = {"running",   "completed", "blocked",     "deviated",
                                    "timed_out", "collided",  "interrupted", "error"};
  return kTexts[static_cast<int>(status)];
}

const Vehicle* TrafficSnapshot::find(const std::string& id) const {
  return findVehicle(vehicles, [&](const Vehicle& vehicle) { return vehicle.id == id; });
}

const Vehicle* TrafficSnapshot::ego() const {
  return findVehicle(vehicles,
                     [](const Vehicle& vehicle) { return vehicle.role == VehicleRole::kEgo; });
}

const Vehicle* TrafficSnapshot::cbv(int slot) const {
  return findVehicle(vehicles, [&](const Vehicle& vehicle) { return vehicle.cbv_slot == slot; });
}

}  // namespace cdiff::traffic
