// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "simulation/traffic_simulator.h"

namespace cdiff::simulation {

constexpr int kNoEdge = -1;

/// The road network as SUMO's routes see it: edges (junctions left out) that follow each other
/// where a lane of one leads to a lane of the other. Edges are numbered in the order of
/// RoadNetwork::edgeIds().
class EdgeGraph {
 public:
  /// A connection from one edge to another, through a junction.
  struct Link {
    int to = kNoEdge;
    map::LaneIndex from_lane = map::kNoLane;  ///< lane to be on
    map::LaneIndex to_lane = map::kNoLane;    ///< lane arrived on
    double turn = 0.0;                        ///< change of heading, absolute [rad]
    bool routable = false;                    ///< both lanes are
  };

  /// Keeps a reference: the network must outlive the graph.
  explicit EdgeGraph(const map::RoadNetwork& network);

  const map::RoadNetwork& network() const { return network_; }
  /// Number of an edge by SUMO's id, or kNoEdge.
  int find(const std::string& id) const;
  /// The edge of a lane; of an internal lane the edge before its junction.
  /// kNoEdge when there is none.
  int edgeOf(map::LaneIndex lane) const { return edge_of_lane_[static_cast<std::size_t>(lane)]; }
  /// The edge that an internal lane leads to; of any other lane its own.
  int edgeAfter(map::LaneIndex lane) const {
    return edge_after_lane_[static_cast<std::size_t>(lane)];
  }
  const std::string& id(int edge) const {
    return network_.edgeIds()[static_cast<std::size_t>(edge)];
  }
  /// Of its first lane [m].
  double length(int edge) const { return at(edge).length; }
  /// Lanes from right to left.
  const std::vector<map::LaneIndex>& lanes(int edge) const { return at(edge).lanes; }
  /// Connections onwards, by lane and then as the network lists them.
  const std::vector<Link>& links(int edge) const { return at(edge).links; }
  bool connected(int from, int to) const;
  /// Whether a lane belongs to a route: to one of its edges, or between two that follow each other.
  bool onRoute(map::LaneIndex lane, const std::vector<int>& edges) const;
  /// The lane that follows `lane` on a route; kNoLane where the route needs another lane, or ends.
  map::LaneIndex nextLane(map::LaneIndex lane, const std::vector<int>& edges) const;
  /// Adds edges at the end, straight on where it can, until they measure `length` [m] and are at
  /// least two; fewer where the network ends. No edge twice: SUMO would take one pass for the
  /// other.
  void extend(std::vector<int>& edges, double length) const;
  std::vector<std::string> ids(const std::vector<int>& edges) const;

 private:
  struct Edge {
    std::vector<map::LaneIndex> lanes;
    std::vector<Link> links;
    double length = 0.0;
  };
  const Edge& at(int edge) const { return edges_[static_cast<std::size_t>(edge)]; }
  void addLinks(Edge& edge, map::LaneIndex from);

  const map::RoadNetwork& network_;
  std::vector<Edge> edges_;
  std::vector<int> edge_of_lane_;
  std::vector<int> edge_after_lane_;
  std::unordered_map<std::string, int> edge_by_id_;
};

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
