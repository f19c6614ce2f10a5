// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A traffic simulator without SUMO: background vehicles keep heading and speed, driven ones are
/// where they are moved to, and what is asked of it is written down.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"
#include "simulation/traffic_simulator.h"
#include "support/snapshot_builder.h"

namespace cdiff::test {

class ScriptedSimulator : public simulation::TrafficSimulator {
 public:
  /// A background vehicle, there from now on.
  void place(const std::string& id, const Motion& motion) {
    simulation::SimulatedVehicle simulated;
    simulated.id = id;
    simulated.state = vehicle(id, motion).state;
    simulated.lane_id = "road_0";
    insert(simulated);
  }
  /// The next step throws: core::InputError where the input is at `fault`, else SimulatorError.
  void failNext(bool at_fault) { failure_ = at_fault ? Failure::kInput : Failure::kLost; }
  /// "take over a", "release a", "remove a", in order.
  std::vector<std::string> asked;
  simulation::DrivenVehicle last_released;

  void addDriven(const std::string& id, const traffic::VehicleDimensions&,
                 const simulation::DrivenVehicle& start) override {
    simulation::SimulatedVehicle simulated;
    simulated.id = id;
    simulated.state = start.state;
    insert(simulated);
  }
  void takeOver(const std::string& id) override { asked.push_back("take over " + id); }
  bool release(const simulation::DrivenVehicle& vehicle) override {
    asked.push_back("release " + vehicle.id);
    last_released = vehicle;
    return true;
  }
  bool addBackground(const std::string&, const std::vector<std::string>&, double, int, double,
                     const traffic::VehicleDimensions&) override {
    return false;
  }
  void remove(const std::string& id) override {
    asked.push_back("remove " + id);
    removed_.push_back(id);
  }
  void step(const std::vector<simulation::DrivenVehicle>& driven) override {
    const Failure failure = failure_;
    failure_ = Failure::kNone;
    if (failure == Failure::kInput) throw core::InputError("the demand is wrong");
    if (failure == Failure::kLost) throw core::SimulatorError("the simulator is gone");
    takeOut();
    for (simulation::SimulatedVehicle& simulated : vehicles_) move(simulated, driven);
  }
  const std::vector<simulation::SimulatedVehicle>& vehicles() const override { return vehicles_; }
  const std::vector<traffic::SignalState>& signals() const override { return signals_; }
  std::string version() const override { return "scripted"; }

 private:
  enum class Failure { kNone, kInput, kLost };
  static constexpr double kStep = 0.05;  ///< [s]

  void insert(const simulation::SimulatedVehicle& simulated) {
    const auto after = std::find_if(vehicles_.begin(), vehicles_.end(),
                                    [&](const auto& other) { return other.id > simulated.id; });
    vehicles_.insert(after, simulated);
  }
  void takeOut() {
    for (const std::string& id : removed_) {
      const auto is_it = [&](const auto& simulated) { return simulated.id == id; };
      vehicles_.erase(std::remove_if(vehicles_.begin(), vehicles_.end(), is_it), vehicles_.end());
    }
    removed_.clear();
  }
  static void move(simulation::SimulatedVehicle& simulated,
                   const std::vector<simulation::DrivenVehicle>& driven) {
    for (const simulation::DrivenVehicle& ours : driven) {
      if (ours.id != simulated.id) continue;
      simulated.state = ours.state;
      return;
    }
    simulated.state.position += kStep * simulated.state.velocity();
  }

  Failure failure_ = Failure::kNone;
  std::vector<std::string> removed_;  ///< leave at the next step
  std::vector<simulation::SimulatedVehicle> vehicles_;
  std::vector<traffic::SignalState> signals_;
};

}  // namespace cdiff::test
