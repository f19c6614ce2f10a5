// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "simulation/traffic_simulator.h"

namespace cdiff::simulation {

/// What SUMO reports after each step, through subscriptions: one message per step instead of one
/// per vehicle and quantity.
/// Its methods are called inside SumoLink::guarded.
class TrafficObserver {
 public:
  /// Subscribes to departures and traffic lights. `lights_green`: every light is set to 'g' first
  /// and for good: vehicles still yield as at a junction without light.
  void start(bool lights_green);
  /// Subscribes to a vehicle that SUMO does not report as departed: one that is moved from its
  /// first step on.
  void watch(const std::string& id) { waiting_.push_back(id); }
  /// A light was changed by us.
  void show(const traffic::SignalState& signal);
  /// Reads the results of the step that was made.
  void read();

  /// The same as `vehicles`, for what is known better than SUMO knows it; ids and order must stay.
  std::vector<SimulatedVehicle>& correctable() { return vehicles_; }
  /// By id.
  const std::vector<SimulatedVehicle>& vehicles() const { return vehicles_; }
  const SimulatedVehicle* find(const std::string& id) const;
  const std::vector<traffic::SignalState>& signals() const { return signals_; }

 private:
  void subscribe(const std::string& id);
  void readSignals();

  bool lights_green_ = true;
  std::vector<SimulatedVehicle> vehicles_;
  std::vector<traffic::SignalState> signals_;
  std::vector<std::string> waiting_;
  std::map<std::string, traffic::VehicleDimensions> dimensions_;          ///< by vehicle
  std::map<std::string, traffic::VehicleDimensions> dimensions_of_type_;  ///< by vehicle type
};

}  // namespace cdiff::simulation
