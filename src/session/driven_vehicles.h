// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "simulation/traffic_simulator.h"

namespace cdiff::session {

/// The vehicles of a session that our own dynamics moves: the ego first, then CBVs by slot (map
/// frame, SI units). Each holds its last action until it gets another one.
class DrivenVehicles {
 public:
  explicit DrivenVehicles(const dynamics::BicycleModelOptions& options);
  ~DrivenVehicles();

  std::size_t size() const { return vehicles_.size(); }
  bool contain(const std::string& id) const;
  /// As the simulator is to move it; nullopt when it is none of ours.
  std::optional<simulation::DrivenVehicle> find(const std::string& id) const;

  void addEgo(const std::string& id, const map::Route& route, const traffic::VehicleState& start);
  /// A vehicle that was the simulator's, from `start` on.
  void addCbv(const cbv::CbvAssignment& assignment, const simulation::SimulatedVehicle& simulated,
              const traffic::VehicleState& start);
  /// Does nothing for a vehicle that is none of ours.
  void remove(const std::string& id);

  /// Takes the actions of a decision. Full braking replaces an invalid one; returns a text for each
  /// of these.
  std::vector<std::string> command(const std::vector<planning::PlannedAction>& actions);
  /// Moves all of them by one simulation step [s]; a vehicle without an action brakes fully.
  void move(double step);

  /// As the simulator is to move them.
  std::vector<simulation::DrivenVehicle> moves() const;
  /// As a snapshot shows them; `simulated` names their lanes.
  std::vector<traffic::Vehicle> snapshot(
      const std::vector<simulation::SimulatedVehicle>& simulated) const;

 private:
  struct Driven;
  using Iterator = std::vector<std::unique_ptr<Driven>>::const_iterator;
  Iterator position(const std::string& id) const;

  dynamics::BicycleModel dynamics_;
  std::vector<std::unique_ptr<Driven>> vehicles_;  ///< by slot; that of the ego is -1
};

// Contacts of the vehicles that we drive: boxes that overlap on the same level at one tick.

/// Contacts of one tick, and who leaves the simulation for them.
struct TickContacts {
  std::vector<traffic::Contact> contacts;
  std::vector<std::string> leaving;  ///< CBVs and background vehicles; one may be there twice
};

/// Looks at the first `driven` of the vehicles, each against all that come after it.
TickContacts findContacts(const std::vector<traffic::Vehicle>& vehicles, std::size_t driven);

}  // namespace cdiff::session
