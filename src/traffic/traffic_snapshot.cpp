// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/traffic/traffic_snapshot.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::traffic {
namespace {

bool within(double value, double low, double high) {
  return std::isfinite(value) && value >= low && value <= high;
}

template <class Predicate>
const Vehicle* findVehicle(const std::vector<Vehicle>& vehicles, Predicate predicate) {
  const auto found = std::find_if(vehicles.begin(), vehicles.end(), predicate);
  return found == vehicles.end() ? nullptr : &*found;
}

}  // namespace

bool ControlAction::valid() const {
  return within(throttle, 0.0, 1.0) && within(steer, -1.0, 1.0) && within(brake, 0.0, 1.0);
}

bool operator==(const ControlAction& left, const ControlAction& right) {
  return left.throttle == right.throttle && left.steer == right.steer && left.brake == right.brake;
}

const char* toText(VehicleRole role) {
  switch (role) {
    case VehicleRole::kEgo:
      return "ego";
    case VehicleRole::kCbv:
      return "cbv";
    case VehicleRole::kBackground:
      break;
  }
  return "background";
}

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
