// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "e2e_cdiff/map/road_network.h"

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
  /// The lane that follows `lane` on a route; kNoLane where the route needs another
  /// lane, or ends.
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

}  // namespace cdiff::simulation
