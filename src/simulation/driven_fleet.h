// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/vehicle.h"
#include "simulation/edge_graph.h"
#include "simulation/sumo_link.h"

namespace cdiff::simulation {

// The vehicles in SUMO that we move.

/// How a released vehicle gets from where it was to where SUMO has it, in the middle of its lane
/// and aligned: front bumper at SUMO's + a along + d to the left, heading SUMO's + e. Per meter
/// driven d' = sin e, e' = -d / L^2 - 2 e / L (critically damped, |e'| <= 0.2 / m), a' = -a / L, L
/// = max(3 m, 0.8 s v).
class SettlingMotion {
 public:
  /// Begins with the state at the release of a vehicle of this length [m].
  SettlingMotion(const traffic::VehicleState& released, double length)
      : state_(released), length_(length) {}
  /// Where the vehicle is `step` seconds later, when SUMO has it at `sumo`.
  const traffic::VehicleState& advance(const traffic::VehicleState& sumo, double step);
  /// Where SUMO has it.
  bool settled() const;

 private:
  void start(const traffic::VehicleState& sumo, double step);
  void decay(double driven, double speed);

  traffic::VehicleState state_;
  double length_;
  bool begun_ = false;
  double along_ = 0.0;          ///< [m]
  double offset_ = 0.0;         ///< to the left [m]
  double heading_error_ = 0.0;  ///< [rad]
};

/// The vehicles that we move. On the lanes of its route SUMO drives such a vehicle along them at
/// the speed that brings it next to where we have it (all of SUMO's checks off), so that followers
/// keep their gap and others yield to it as to any vehicle; elsewhere it is moved to its exact
/// place (moveToXY). What the simulator reports of it is our state. Hands vehicles over in both
/// directions without a jump.
/// Its methods are called inside SumoLink::guarded.
class DrivenFleet {
 public:
  /// References must outlive the fleet. `match_threshold`: how far from a lane SUMO looks for one
  /// [m]; `step`: of the simulation [s].
  DrivenFleet(SumoLink& link, const EdgeGraph& graph, double match_threshold, double step)
      : link_(link),
        calls_(link.calls()),
        graph_(graph),
        match_threshold_(match_threshold),
        step_(step) {}

  bool contains(const std::string& id) const { return vehicles_.count(id) != 0; }
  /// Adds a vehicle to SUMO that is moved from its first step on.
  void add(const DrivenVehicle& start, const traffic::VehicleDimensions& dimensions,
           const std::string& type_id);
  /// Takes over a vehicle that SUMO drives.
  void takeOver(const SimulatedVehicle& vehicle);
  /// Releases a vehicle to SUMO; returns false, changing nothing, where it is on no lane of its
  /// direction.
  bool release(const DrivenVehicle& vehicle);
  /// Forgets a vehicle without touching it.
  void forget(const std::string& id);
  /// Says where a vehicle will be after the coming step.
  void move(const DrivenVehicle& vehicle);
  const traffic::VehicleDimensions& dimensions(const std::string& id) const {
    return vehicles_.at(id).route.dimensions();
  }
  /// To be called after each step with what SUMO reports (by id): notes where SUMO has our
  /// vehicles, and writes where they are; brings released vehicles into the middle of their lane.
  void report(std::vector<SimulatedVehicle>& vehicles);

 private:
  static constexpr int kSpeedModeOff = 32;  ///< none of SUMO's checks
  static constexpr int kSpeedModeDefault = 31;
  static constexpr int kLaneChangeModeOff = 512;  ///< no lane change of its own
  struct Moved {
    explicit Moved(const DrivenRoute& driven_route) : route(driven_route) {}
    DrivenRoute route;
    std::vector<int> given;       ///< edges of its SUMO route, from the edge where it was set
    bool on_route = false;        ///< SUMO's route is `given` and the vehicle is on its lanes
    bool outdated = false;        ///< SUMO is to get a better route
    std::string refused_lane;     ///< lane on which SUMO refused the last route
    int last_edge = kNoEdge;      ///< SUMO's edge after the last step
    bool reported = false;        ///< SUMO has it in the network
    std::string lane_id;          ///< SUMO's lane after the last step; empty off the road
    LanePlace place;              ///< the same, with the place on it
    bool along_lane = false;      ///< SUMO drives it along the lane
    bool placed = false;          ///< put on its lane for the last step, not driven along it
    double changing = 0.0;        ///< until SUMO has ended a lane change of its own [s]
    double speed = -1.0;          ///< last commanded [m/s]
    traffic::VehicleState state;  ///< ours, after the coming step
  };
  struct Released {
    SettlingMotion motion;
    bool settled = false;
    double left = 0.0;  ///< until lane changes are allowed again [s]
  };
  void setModes(const std::string& id, int speed_mode);
  void note(Moved& moved, const SimulatedVehicle& vehicle) const;
  bool changesLane(const Moved& moved) const;
  static void leaveRoute(Moved& moved);
  void updateRoute(const std::string& id, Moved& moved, const FrontPlace& place);
  bool setRoute(const std::string& id, Moved& moved, const std::vector<int>& edges);
  bool moveAlongLane(const std::string& id, Moved& moved, const FrontPlace& place);
  /// Whether SUMO 1.15 survives that the vehicle is put elsewhere: only when it is wholly on one
  /// lane and not changing lanes; else followers find it on lanes that it has left, and SUMO ends
  /// itself.
  bool mayJump(const Moved& moved) const;
  /// Whether it may leave the road: a vehicle that was put on its lane for the last step must be
  /// driven for one first. Otherwise SUMO 1.15 ends itself a step later, as others still find it on
  /// that lane.
  bool mayLeaveRoad(const Moved& moved, const FrontPlace& place) const;
  /// Lets SUMO drive it on where it is, beside where we have it, until it may jump.
  void keepToLane(const std::string& id, Moved& moved, const FrontPlace& place);
  bool onAnotherLane(const FrontPlace& place, map::LaneIndex lane) const;
  bool putOnLane(const std::string& id, const LanePlace& place);
  /// Off its route but still next to the lane where SUMO has it: stays there, as an obstacle.
  bool stayOnLane(const std::string& id, Moved& moved, const FrontPlace& place);
  void moveFreely(const std::string& id, Moved& moved, const FrontPlace& place);
  double usableLength(map::LaneIndex lane, const Moved& moved) const;
  double sumoScale(map::LaneIndex lane);
  int edgeOf(const std::string& lane_id) const;
  bool settle(SimulatedVehicle& vehicle, Released& released);

  SumoLink& link_;
  const SumoCalls& calls_;
  const EdgeGraph& graph_;
  double match_threshold_;
  double step_;
  std::map<std::string, Moved> vehicles_;
  std::map<std::string, Released> released_;
  std::map<map::LaneIndex, double> scales_;  ///< SUMO's length of a lane over its centerline's
  std::uint64_t added_ = 0;
};

}  // namespace cdiff::simulation
