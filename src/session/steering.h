// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::session {

// Steering as data: what a running session can be told, as a line of a scenario and as a request.

namespace steered = traffic::steered;

/// One thing that is asked of a running session: a subject of traffic::steered and its value,
/// written as in traffic::SteeringChange; a vehicle to place as a PlacedVehicle.
struct SteeringRequest {
  std::string by;  ///< who asks
  std::string what;
  std::string value;
};

/// A background vehicle to be placed on a lane.
struct PlacedVehicle {
  std::string id;
  std::string lane;       ///< id of the lane
  double position = 0.0;  ///< of the box's center along the lane [m]
  double speed = 0.0;     ///< [m/s]
};

/// "ID LANE POSITION SPEED", which placedVehicle reads back to the same values.
std::string toText(const PlacedVehicle& vehicle);
/// Throws InputError for any other text.
PlacedVehicle placedVehicle(const std::string& text);

/// One line of a scenario's list `steering`: what changes at a simulated time. Empty texts and a
/// target speed of 0 are not given.
struct SteeringEntry {
  double at = 0.0;  ///< simulated time; in force at the first decision from then on [s]
  std::string profile;
  std::string mode;
  std::string objective;      ///< gets the weight beside it
  double weight = 0.0;        ///< w_i
  double target_speed = 0.0;  ///< [m/s]
  std::string choose;         ///< id of a vehicle, as the three below
  std::string release;
  std::string remove;
  std::string place;      ///< with the three below
  std::string lane;       ///< id of a lane
  double position = 0.0;  ///< of the vehicle's center along the lane [m]
  double speed = 0.0;     ///< [m/s]

  void describe(core::OptionsVisitor& visitor);
};

/// What an entry asks for, in the order of its fields.
std::vector<SteeringRequest> requestsOf(const SteeringEntry& entry);
/// The entry that asks for it again at a time [s].
SteeringEntry entryOf(const traffic::SteeringChange& change, double at);
/// "{at: 12, profile: safety_critical}": the fields that are given, as YAML.
std::string flowText(const SteeringEntry& entry);

/// A change in the record of a session.
struct SteeringRecord {
  std::uint64_t tick = 0;  ///< of the snapshot that it came with
  traffic::SteeringChange change;
  std::string refused{};  ///< why CBV identification did not take a chosen vehicle; else empty

  bool byHand() const { return change.by != traffic::kSteeredByScenario; }
};

/// Ids and roles of the vehicles of a tick.
using VehicleRoles = std::map<std::string, traffic::VehicleRole>;

}  // namespace cdiff::session
