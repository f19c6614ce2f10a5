// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "simulation/edge_graph.h"
#include "simulation/traffic_simulator.h"

namespace cdiff::simulation {

/// Where a vehicle's front bumper is among the lanes.
struct FrontPlace {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  std::vector<map::LaneMatch> lanes;  ///< that it is within SUMO's reach of, nearest first
};

/// The route of a vehicle that we drive, as edges for SUMO: from its present edge along its route,
/// always beyond the next junction, because other traffic yields to a vehicle only where its SUMO
/// route says that it will cross theirs. Front bumper in the map frame [m].
class DrivenRoute {
 public:
  /// `graph` must outlive the object.
  DrivenRoute(const EdgeGraph& graph, const traffic::VehicleDimensions& dimensions)
      : graph_(&graph), dimensions_(dimensions) {}

  const traffic::VehicleDimensions& dimensions() const { return dimensions_; }
  /// Lanes near the front bumper of a state: those on which SUMO lets others see the vehicle,
  /// distance < (lane + vehicle width)/2.
  FrontPlace locate(const traffic::VehicleState& state) const;
  /// Follows the route on to the front bumper; returns whether it is another route than before.
  bool follow(const map::Route* route, const Eigen::Vector2d& front);
  /// Edges from `current` on: along the route where that edge is on it, else straight on; at least
  /// `length` meters after `current` where the network allows.
  std::vector<int> edgesFrom(int current, double length) const;
  /// The edge to start on, at the route's place or on the nearest lane of the same direction;
  /// kNoEdge where there is none.
  int startEdge(const FrontPlace& place) const;
  /// Whether one of the lanes at the place belongs to a route.
  bool onRoute(const FrontPlace& place, const std::vector<int>& edges, double heading_limit) const;

 private:
  std::optional<std::size_t> routeIndexOf(int current, const std::vector<int>& edges) const;

  const EdgeGraph* graph_;
  traffic::VehicleDimensions dimensions_;
  const map::Route* route_ = nullptr;
  double route_length_ = 0.0;
  std::vector<int> route_edges_;
  double progress_ = 0.0;          ///< of the front bumper along the route [m]
  std::size_t progress_edge_ = 0;  ///< index into route_edges_
};

// Where on SUMO's lanes a vehicle that we drive belongs, and the route from where SUMO has it to
// there [m along the lanes].

/// A place on a lane, of a front bumper.
struct LanePlace {
  map::LaneIndex lane = map::kNoLane;
  double arc_length = 0.0;  ///< along the lane's centerline [m]
};

/// The place next to which the front bumper is, and how far it is from `from`.
struct LaneTarget {
  LanePlace place;
  std::optional<double> ahead;  ///< driven length from `from`; absent where that
                                ///< is not on the way there [m]
};

/// The nearest place on a lane of `edges` (in driving order) whose direction is the vehicle's. The
/// lanes that `from` leads to are preferred to others that are nearer by little, so that lanes that
/// overlap do not make the target jump. nullopt when there is none.
std::optional<LaneTarget> laneTarget(const EdgeGraph& graph, const FrontPlace& front,
                                     double heading, const std::vector<int>& edges,
                                     const LanePlace& from);

}  // namespace cdiff::simulation
