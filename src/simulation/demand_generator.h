// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "map/lane_graph.h"
#include "simulation/edge_graph.h"

namespace cdiff::simulation {

// Routes of generated vehicles: seeded random walks over lane-connected edges that prefer edges
// near the ego route; and whether a place on a lane is free for a vehicle (gaps along the lane
// [m], speeds [m/s]).

/// Finds routes for background vehicles on the edge graph, preferring edges near the ego's route.
class DemandRouter {
 public:
  /// `graph` must outlive the router. Edges within `radius` [m] of the ego route are preferred.
  DemandRouter(const EdgeGraph& graph, const map::Route& ego_route, double radius);

  /// Edges from `lane` on, driven on from `arc_length` of it, at least `length` meters long where
  /// the network allows: every edge is reached from a lane that the vehicle can be on. `key` names
  /// the family of draws.
  std::vector<int> route(map::LaneIndex lane, double arc_length, double length,
                         const core::RandomStream& random, const core::RandomKey& key) const;

 private:
  std::vector<const EdgeGraph::Link*> ways(int edge, map::LaneIndex lane, double room) const;
  double weight(const EdgeGraph::Link& link) const;

  const EdgeGraph& graph_;
  std::vector<bool> near_;  ///< by edge
};

/// A place where a vehicle starts.
struct Insertion {
  map::LaneIndex lane = map::kNoLane;
  double front = 0.0;  ///< place of the front bumper along the lane [m]
  double speed = 0.0;  ///< desired [m/s]
  traffic::VehicleDimensions dimensions;
};

/// Pose of the center of a vehicle that starts there.
traffic::VehicleState stateAt(const map::RoadNetwork& network, const Insertion& insertion);

/// The speed to start with: the desired one, less behind a leader or before the lane's end; nullopt
/// where a gap to a vehicle is too small.
std::optional<double> freeSpeed(const map::RoadNetwork& network, const Insertion& insertion,
                                const std::vector<traffic::Vehicle>& vehicles);

/// Generated background traffic around the ego: how much, where, and with which spread of drivers
/// (SI units).
struct DemandOptions {
  std::int64_t density = 30;       ///< vehicles kept alive within `radius` of the ego
  double radius = 150.0;           ///< largest distance from the ego's route [m]
  double clear_start = 10.0;       ///< none is placed nearer to the ego's start [m]
  double warm_up = 30.0;           ///< driven before the session starts [s]
  double forget_distance = 300.0;  ///< a vehicle farther from the ego leaves the simulation [m]

  void describe(core::OptionsVisitor& visitor);
};

/// A vehicle to be added.
struct DemandVehicle {
  std::string id;                  ///< "bg_0", "bg_1", ...
  std::vector<std::string> edges;  ///< SUMO route
  double depart_position = 0.0;    ///< place of the front bumper along the first edge [m]
  int depart_lane = 0;
  double depart_speed = 0.0;  ///< [m/s]
  traffic::VehicleDimensions dimensions;
};

/// Begins the ids of generated vehicles, and of no others.
inline constexpr const char* kGeneratedPrefix = "bg_";

/// Generated demand: seeded background vehicles on lane-connected routes that start near the ego
/// route, on both directions and every approach of its junctions; keeps `density` of them alive
/// near the ego.
class DemandGenerator {
 public:
  /// References must outlive the generator.
  DemandGenerator(const DemandOptions& options, const map::LaneGraph& graph,
                  const map::Route& ego_route, std::uint64_t seed);
  /// The next vehicle to try at this place and time given those present; nullopt when enough are
  /// alive near `ego_position` or no free place is left. Call repeatedly within a step.
  std::optional<DemandVehicle> next(const std::vector<traffic::Vehicle>& present,
                                    const Eigen::Vector2d& ego_position, double ego_elevation,
                                    bool warm_up);

 private:
  /// Where a vehicle may begin: its front bumper on a lane.
  struct Start {
    map::LaneIndex lane = map::kNoLane;
    double front = 0.0;                                  ///< along the lane [m]
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of the front bumper [m]
    double elevation = 0.0;                              ///< [m]
  };
  void collectStarts();
  void addStartsOf(map::LaneIndex lane);
  bool allowed(const Start& start, const Eigen::Vector2d& ego_position, double ego_elevation,
               bool warm_up) const;
  std::size_t countNear(const std::vector<traffic::Vehicle>& vehicles,
                        const Eigen::Vector2d& ego_position) const;
  void forgetOldCandidates(const std::vector<traffic::Vehicle>& present);
  std::optional<DemandVehicle> tryStart(const Start& start,
                                        const std::vector<traffic::Vehicle>& vehicles);

  DemandOptions options_;
  const map::Route& ego_route_;
  core::RandomStream random_;
  EdgeGraph edges_;
  DemandRouter router_;
  std::vector<Start> starts_;
  std::uint32_t draws_ = 0;                  ///< attempts so far: the counter of the random stream
  std::uint32_t count_ = 0;                  ///< vehicles so far
  std::vector<traffic::Vehicle> announced_;  ///< returned in this step, not yet in the simulation
  double fingerprint_ = 0.0;                 ///< of the vehicles in the simulation at the last call
};

}  // namespace cdiff::simulation
