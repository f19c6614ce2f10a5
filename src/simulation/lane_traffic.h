// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "map/lane_graph.h"
#include "simulation/traffic_simulator.h"

namespace cdiff::simulation {

/// Constants of LaneTraffic's drivers; defaults are those of SUMO's passenger car where it has
/// them.
struct LaneTrafficOptions {
  double acceleration = 2.6;          ///< a [m/s^2]
  double deceleration = 4.5;          ///< b, comfortable [m/s^2]
  double hardest_deceleration = 8.0;  ///< [m/s^2]
  double minimum_gap = 2.5;           ///< s0 [m]
  double time_headway = 1.0;          ///< T [s]
  double route_length = 500.0;        ///< after which a vehicle leaves; less where lanes end [m]
};

/// Background traffic in this process, without SUMO (map frame, SI units): each vehicle follows a
/// route along lanes by the intelligent driver model (Treiber et al. 2000), dv/dt = a [1 - (v/v0)^4
/// - (s*/s)^2], s* = s0 + v T + v dv / (2 sqrt(a b)), behind whatever is on its path. It is many
/// times faster than SUMO, and any number of instances can run in one process, each in its own
/// thread; made for training that needs millions of decisions (planners/ppo/training), not for
/// evaluation.
///
/// Simpler than SUMO: vehicles change lanes only where their route requires it; traffic lights are
/// green. At a junction a vehicle yields to those that it would meet within two seconds: always to
/// vehicles that we drive, to others if they arrive first (ties by id). Two vehicles that block
/// each other's path drive through each other. The same calls give the same traffic.
class LaneTraffic : public TrafficSimulator {
 public:
  /// `graph` must outlive the object; `step` is the simulation step [s].
  LaneTraffic(const map::LaneGraph& graph, double step, const LaneTrafficOptions& options = {});
  ~LaneTraffic() override;

  void addDriven(const std::string& id, const traffic::VehicleDimensions& dimensions,
                 const DrivenVehicle& start) override;
  void takeOver(const std::string& id) override;
  /// The vehicle continues along the route that it was driven on; if it is more than 2 m or 30
  /// degrees off that route, it is removed and the result is false.
  bool release(const DrivenVehicle& vehicle) override;
  bool addBackground(const std::string& id, const std::vector<std::string>& edges,
                     double depart_position, int depart_lane, double depart_speed,
                     const traffic::VehicleDimensions& dimensions) override;
  void remove(const std::string& id) override;
  void step(const std::vector<DrivenVehicle>& driven) override;
  const std::vector<SimulatedVehicle>& vehicles() const override { return reported_; }
  const std::vector<traffic::SignalState>& signals() const override { return signals_; }
  std::string version() const override { return "lane traffic"; }

 private:
  /// A vehicle: ours, or one that follows its route.
  struct Car {
    SimulatedVehicle state;
    bool ours = false;
    map::Route route;          ///< not used for ours
    double place = 0.0;        ///< arc length of the center [m]
    double offset = 0.0;       ///< to the left of the route, decaying after a release [m]
    double turned = 0.0;       ///< heading relative to the route, decaying likewise [rad]
    double limit_share = 1.0;  ///< desired speed / speed limit of the lane
    map::LaneIndex lane = map::kNoLane;

    double front() const { return place + 0.5 * state.dimensions.length; }
    geometry::OrientedBox box() const {
      return {state.state.position, state.state.heading, state.dimensions.length,
              state.dimensions.width};
    }
  };
  /// What a car must not run into: free path up to it [m] and its speed along the path [m/s].
  struct Obstacle {
    double gap = 0.0;
    double speed = 0.0;
  };
  /// Lanes along SUMO edges from `arc_length` [m] on `lane` of the first edge; empty where the
  /// edges are not connected.
  map::LanePath lanesAlong(const std::vector<std::string>& edges, int lane,
                           double arc_length) const;
  Car& carOf(const std::string& id);
  void place(Car& car) const;
  void move(Car& car) const;
  double accelerationOf(const Car& car) const;
  double accelerationBehind(const Car& car, const Obstacle& obstacle) const;
  bool onPath(const Car& car, const Car& other, double look_ahead, Obstacle& obstacle) const;
  bool crossesPath(const Car& car, const Car& other, double look_ahead, Obstacle& obstacle) const;
  static traffic::VehicleState ahead(const Car& car, double time);

  const map::LaneGraph& graph_;
  double step_;
  LaneTrafficOptions options_;
  std::map<std::string, std::unique_ptr<Car>> cars_;  ///< by id
  std::vector<SimulatedVehicle> reported_;
  std::vector<traffic::SignalState> signals_;  ///< none
  std::uint64_t steps_ = 0;
};

}  // namespace cdiff::simulation
