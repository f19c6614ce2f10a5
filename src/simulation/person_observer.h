// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "simulation/sumo_calls.h"
#include "simulation/traffic_simulator.h"

namespace cdiff::simulation {

/// Whether a demand has persons. An empty path has none. Throws InputError for a file that cannot
/// be read.
bool hasPersons(const std::filesystem::path& demand_file);

/// The persons of a demand who walk, as bodies among the vehicles (map frame, SI units; position =
/// center of the body). Those in a vehicle are not seen. They are on no lane for cars.
class PersonObserver {
 public:
  /// `calls` must outlive the object.
  explicit PersonObserver(const SumoCalls& calls) : calls_(calls) {}

  /// Adds those of the step that was made to `vehicles`, which stay in order of their ids. One with
  /// the id of a vehicle is left out.
  void addTo(std::vector<SimulatedVehicle>& vehicles);
  /// Whether such a person walked in the step that was made.
  bool contains(const std::string& id) const { return walking_.count(id) != 0; }
  /// Takes the person out of the simulation.
  void remove(const std::string& id);

 private:
  SimulatedVehicle bodyOf(const std::string& id, const PersonState& person);

  const SumoCalls& calls_;
  std::set<std::string> walking_;
  std::map<std::string, traffic::VehicleDimensions> dimensions_of_type_;
};

}  // namespace cdiff::simulation
