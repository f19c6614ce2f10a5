// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Routes of generated vehicles: seeded random walks over lane-connected edges that prefer edges
/// near the ego route; and whether a place on a lane is free for a vehicle (gaps along the lane
/// [m], speeds [m/s]).
#pragma once

#include <optional>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "simulation/edge_graph.h"

namespace cdiff::simulation {

class DemandRouter {
 public:
  /// `graph` must outlive the router. Edges within `radius` [m] of the ego route are preferred.
  DemandRouter(const EdgeGraph& graph, const map::Route& ego_route, double radius);

  /// Edges from `lane` on, driven on from `arc_length` of it, at least `length` metres long where
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

/// A place where a vehicle is to begin.
struct Insertion {
  map::LaneIndex lane = map::kNoLane;
  double front = 0.0;  ///< of the front bumper along the lane [m]
  double speed = 0.0;  ///< wished [m/s]
  traffic::VehicleDimensions dimensions;
};

/// Pose of the centre of a vehicle that begins there.
traffic::VehicleState stateAt(const map::RoadNetwork& network, const Insertion& insertion);

/// The speed to begin with: as wished, less behind a leader or before the lane's end; nullopt where
/// a gap to a vehicle is too small.
std::optional<double> freeSpeed(const map::RoadNetwork& network, const Insertion& insertion,
                                const std::vector<traffic::Vehicle>& vehicles);

}  // namespace cdiff::simulation
