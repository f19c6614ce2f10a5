// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/map/route.h"

namespace cdiff::map {

// Shortest routes from lane to lane.

/// A place on a lane.
struct LanePosition {
  LaneIndex lane = kNoLane;
  double arc_length = 0.0;  ///< along the lane's centerline [m]
};

/// Lanes in driving order; neighbors in the list follow each other or lie side by side (a lane
/// change).
struct LanePath {
  std::vector<LaneIndex> lanes;
  double length = 0.0;  ///< driven length from start to goal [m], lane-change penalty not included
};

/// Connections that turn round (SUMO's direction t): the lane that they leave and the next one, an
/// internal lane where there is one.
using TurnRounds = std::set<std::pair<LaneIndex, LaneIndex>>;

/// All of a network.
TurnRounds turnRounds(const RoadNetwork& network);

/// How many there are and the lanes of the first few, for people; empty when there is none.
std::string turnRoundText(const RoadNetwork& network);

/// The lanes of a network as a graph, searched for shortest routes: along lanes, through junctions,
/// and (with a small penalty) to neighboring lanes. Connections that turn round are used only where
/// they are allowed.
class LaneGraph {
 public:
  /// Keeps a reference: the network must outlive the graph.
  explicit LaneGraph(const RoadNetwork& network) : network_(network) {}

  /// The graph with the turns round that a route of the network makes.
  LaneGraph allowingTurnsOf(const Route& route) const;

  /// Shortest route between two places over routable lanes (the start's and the goal's lane always
  /// count); nullopt when there is none no longer than `max_length` [m]. `lane_changes` allows
  /// changes to neighboring lanes; a change ranks as 5 m, more on lanes shorter than 25 m and
  /// inside junctions. Its length is not driven.
  std::optional<LanePath> shortestPath(const LanePosition& start, const LanePosition& goal,
                                       double max_length, bool lane_changes = true) const;

  /// Driven length from `start` to the start of each lane within `max_length` [m], infinity
  /// elsewhere: one search for many goals. `arrival(goal)` = value[lane] + goal arc length, or
  /// direct on the start's own lane (whose value is that of the way round). Beside the start the
  /// value is minus the arc length abreast of it: an arrival below 0 lies behind.
  std::vector<double> distancesFrom(const LanePosition& start, double max_length,
                                    bool lane_changes = true) const;

  /// Points about 1 m apart along a route, from `start` to `goal_arc_length` on the last lane. Lane
  /// changes are blended over up to 25 m, corners of centerlines rounded over 1.5 m to both sides,
  /// and jogs left out where lanes overlap (the route is then shorter than the path's length).
  Route toRoute(const LanePath& path, double start_arc_length, double goal_arc_length) const;

  /// The route lengthened to at least `length` meters and beyond the junction it would end in,
  /// going straight on where it can (ties by lane index); shorter where the network ends.
  Route extended(const Route& route, double length) const;

  const RoadNetwork& network() const { return network_; }

 private:
  const RoadNetwork& network_;
  TurnRounds turn_rounds_;  ///< allowed
};

}  // namespace cdiff::map
