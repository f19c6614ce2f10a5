// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Snapshots, selections and controls with values that no shorter decimal or float32 can carry, to
/// show that conversions lose nothing.
#pragma once

#include <string>

#include "boost/make_shared.hpp"
#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::test {

inline traffic::Vehicle sampleVehicle(const std::string& id, traffic::VehicleRole role, int slot) {
  traffic::Vehicle vehicle;
  vehicle.id = id;
  vehicle.role = role;
  vehicle.cbv_slot = slot;
  vehicle.state = {{1.0 / 3.0, -2.0e5 / 7.0}, 0.1, -3.141592653589793, 1.0e-17};
  vehicle.dimensions = {4.3, 1.7, 1.45};
  vehicle.acceleration = -1.0 / 9.0;
  vehicle.yaw_rate = 5e-324;  // the smallest number above zero
  vehicle.lane_id = ":junction_3_0";
  return vehicle;
}

/// Ego, CBV of slot 1, one background vehicle; a decision tick.
inline traffic::TrafficSnapshot sampleSnapshot(std::uint64_t tick) {
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = tick;
  snapshot.time = static_cast<double>(tick) * 0.05;
  snapshot.decision_tick = true;
  snapshot.vehicles = {sampleVehicle("ego", traffic::VehicleRole::kEgo, -1),
                       sampleVehicle("bg_7", traffic::VehicleRole::kCbv, 1),
                       sampleVehicle("bg_9", traffic::VehicleRole::kBackground, -1)};
  snapshot.vehicles[0].applied_action = traffic::ControlAction{0.1, -0.2, 0.3};
  snapshot.signals = {{"light", "rGy"}};
  snapshot.contacts = {{"bg_7", "ego"}};
  snapshot.removed = {"bg_1", "bg_2"};
  snapshot.steering = {{"scenario", "profile", "none", "naturalistic"},
                       {"node /panel", "choose", "", "bg_9"}};
  snapshot.faults = {{tick, "planner", "text with \"quotes\" and\na line"}};
  return snapshot;
}

inline ::e2e_cdiff::ControlAction::Ptr controlFor(std::uint64_t tick, int slot,
                                                  const std::string& vehicle_id) {
  auto control = boost::make_shared<::e2e_cdiff::ControlAction>();
  control->tick = tick;
  control->slot = slot;
  control->vehicle_id = vehicle_id;
  control->throttle = 0.25;
  control->planner = slot < 0 ? "ego:sample" : "cbv:sample";
  control->planner_latency_ms = 1.5;
  return control;
}

/// Assigns vehicle to slot, without route.
inline ::e2e_cdiff::CbvSelection::Ptr selectionFor(std::uint64_t tick, int slot,
                                                   const std::string& vehicle_id) {
  auto selection = boost::make_shared<::e2e_cdiff::CbvSelection>();
  selection->tick = tick;
  selection->assignments.resize(1);
  selection->assignments[0].slot = slot;
  selection->assignments[0].vehicle_id = vehicle_id;
  return selection;
}

}  // namespace cdiff::test
