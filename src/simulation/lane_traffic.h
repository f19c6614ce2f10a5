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
  double route_length = 500.0;        ///< driven before a vehicle leaves, less where lanes end [m]
};

/// Background traffic in this process, without SUMO: each vehicle follows a route along lanes by
/// the intelligent driver model (Treiber et al. 2000), dv/dt = a [1 - (v/v0)^4 - (s*/s)^2], s* = s0
/// + v T + v dv / (2 sqrt(a b)), behind whatever is on its path. Many times as fast as SUMO, and as
/// many of it as one likes may run in a process, each in its own thread; made for training that
/// needs millions of decisions, not for evaluation.
///
/// Simpler than SUMO: no lane changes but those that the route needs; traffic lights are green; at
/// junctions a vehicle yields to whom it would meet within two seconds, to vehicles that we drive
/// always, to others where they come first (ties by id); two that stand across each other's path go
/// on through each other. The same calls give the same traffic.
class LaneTraffic : public TrafficSimulator {
 public:
  /// `graph` must outlive the object; `step` is the simulation step [s].
  LaneTraffic(const map::LaneGraph& graph, double step, const LaneTrafficOptions& options = {});
  ~LaneTraffic() override;

  void addDriven(const std::string& id, const traffic::VehicleDimensions& dimensions,
                 const DrivenVehicle& start) override;
  void takeOver(const std::string& id) override;
  /// Along the route that it was driven on; false, and removed, more than 2 m or 30 degrees off it.
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
    map::Route route;          ///< of ours: not used
    double place = 0.0;        ///< arc length of the center [m]
    double offset = 0.0;       ///< to the left of the route, decaying after a release [m]
    double turned = 0.0;       ///< heading against the route, likewise [rad]
    double limit_share = 1.0;  ///< of the lane's limit that it drives at
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
  /// Lanes from a place along SUMO edges; empty where they do not follow each other.
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
