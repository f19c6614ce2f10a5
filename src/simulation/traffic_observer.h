// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "simulation/sumo_calls.h"
#include "simulation/traffic_simulator.h"

namespace cdiff::simulation {

/// What SUMO reports after each step, through subscriptions: one message per step instead of one
/// per vehicle and quantity.
/// Its methods are called inside SumoLink::guarded.
class TrafficObserver {
 public:
  /// `calls` must outlive the observer.
  explicit TrafficObserver(const SumoCalls& calls) : calls_(calls) {}
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

  /// The same as `vehicles`, for what is known better than SUMO knows it, and for who else is
  /// there; the order must stay that of the ids.
  std::vector<SimulatedVehicle>& correctable() { return vehicles_; }
  /// By id.
  const std::vector<SimulatedVehicle>& vehicles() const { return vehicles_; }
  const SimulatedVehicle* find(const std::string& id) const;
  const std::vector<traffic::SignalState>& signals() const { return signals_; }

 private:
  void subscribe(const std::string& id);
  void readVehicles();
  void readSignals();

  const SumoCalls& calls_;
  bool lights_green_ = true;
  std::vector<SimulatedVehicle> vehicles_;
  std::vector<traffic::SignalState> signals_;
  std::vector<std::string> waiting_;
  std::map<std::string, traffic::VehicleDimensions> dimensions_;          ///< by vehicle
  std::map<std::string, traffic::VehicleDimensions> dimensions_of_type_;  ///< by vehicle type
};

/// Answers whether a vehicle is driven by us.
using IsDriven = std::function<bool(const std::string& id)>;

/// From now on a vehicle may go without yielding to approaching vehicles, or has to yield again.
struct RightOfWayChange {
  std::string vehicle_id;
  bool may_go = false;
};

/// What changes after a step.
struct RightOfWayChanges {
  std::vector<RightOfWayChange> vehicles;
  std::vector<traffic::SignalState> signals;
};

/// Who goes first where every signal is green: vehicles yield to each other, so several that wait
/// for each other would wait forever. As drivers do, the one that has waited longest at a still
/// junction goes first: those inside it, then those ahead of a vehicle of ours, then all others.
class RightOfWay {
 public:
  /// `signals`: all lights with their 'g' states. `network` must outlive the object.
  RightOfWay(const map::RoadNetwork& network, const std::vector<traffic::SignalState>& signals);

  /// Changes after a step of `step` seconds. No vehicle may go while another moves in the junction
  /// or toward it. To ours, traffic always yields: while one of ours comes, only those go that
  /// stand ahead of it on its own edge, and other grants end. A queue ahead of ours at a light has
  /// priority ('G') until ours is the first.
  RightOfWayChanges update(const std::vector<SimulatedVehicle>& vehicles, const IsDriven& is_driven,
                           double step);

 private:
  /// What goes on at a junction in this step, and who may go.
  struct JunctionState {
    bool moving = false;           ///< a vehicle moves in it or toward it
    std::string ours_edge;         ///< edge on which ours comes or waits; empty when none
    bool ours_coming = false;      ///< one of ours moves toward it
    bool ours_near = false;        ///< ... and arrives within seconds
    bool ours_on_several = false;  ///< ours come on different edges
    double ours_to_end = 0.0;      ///< of ours on `ours_edge` [m]
    bool queue_ahead_of_ours = false;
    std::string signal_id;                          ///< its light; empty when none
    std::map<std::string, std::vector<int>> links;  ///< of the light, by edge
    std::string priority_edge;                      ///< edge that shows 'G'; empty when none
    const SimulatedVehicle* first = nullptr;        ///< next to go of those that wait
    double first_rank = 0.0;                        ///< wait [s], larger by far inside the junction
    std::string first_edge;
    std::string granted;  ///< vehicle that may go; empty when none
    std::string granted_edge;
    bool granted_gone = true;
    bool granted_stands = false;
    double granted_time = 0.0;  ///< [s]
  };

  /// A vehicle on a lane of a junction.
  struct Place {
    JunctionState& junction;
    const map::Lane& lane;
    double to_end = 0.0;  ///< front bumper to the stop line; 0 inside [m]
  };

  void look(const SimulatedVehicle& vehicle, bool ours, double step);
  static void lookAtOurs(const SimulatedVehicle& vehicle, const Place& place);
  static void consider(const SimulatedVehicle& vehicle, const Place& place, double wait);
  static void noteQueue(const Place& place);
  void decide(JunctionState& junction, double step, std::vector<RightOfWayChange>& changes);
  void light(JunctionState& junction, std::vector<traffic::SignalState>& changes) const;

  const map::RoadNetwork& network_;
  std::vector<JunctionState> junctions_;
  std::map<std::string, std::string> all_yield_;  ///< 'g' state by light
  std::vector<int>
      junction_of_lane_;  ///< of internal lanes and lanes that end at a junction; -1: none
  std::map<std::string, double> waiting_;  ///< [s] by vehicle
};

}  // namespace cdiff::simulation
