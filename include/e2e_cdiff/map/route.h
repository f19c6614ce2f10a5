// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/map/road_network.h"

namespace cdiff::map {

/// Where on its route a vehicle is looked for after a tick or a decision: farther than it drives in
/// between, nearer than a route usually comes back to itself.
inline constexpr geometry::SearchWindow kRouteWindow{5.0, 15.0};

/// A lane-connected route through the network: points (x, y, z) about 1 m apart in the map frame,
/// each with its lane.
class Route {
 public:
  Route() = default;
  /// `points` (at least two, distinct) and the lane of each. Keeps a copy of what it needs of the
  /// network.
  Route(const RoadNetwork& network, const std::vector<Eigen::Vector3d>& points,
        const std::vector<LaneIndex>& lanes);

  /// Whether it was made without points.
  bool empty() const { return path_.empty(); }
  /// Arc length of its end [m].
  double length() const { return path_.length(); }
  /// Its points as a line.
  const geometry::Polyline& path() const { return path_; }
  /// Lane of each point of `path()`.
  const std::vector<LaneIndex>& lanes() const { return lanes_; }
  /// Lane at an arc length.
  LaneIndex laneAt(double arc_length) const;
  /// Speed limit of the lane at an arc length [m/s].
  double speedLimitAt(double arc_length) const;
  /// Whether the lane at an arc length lies inside a junction.
  bool inJunctionAt(double arc_length) const;
  /// SUMO edges in driving order, without internal ones and without repetition of neighbors.
  const std::vector<std::string>& edges() const { return edges_; }
  /// Arc length of the first point on `edges()[i]`, for each edge.
  const std::vector<double>& edgeStarts() const { return edge_starts_; }
  /// Arc lengths [begin, end] inside junctions, in order.
  const std::vector<std::pair<double, double>>& junctionStretches() const { return junctions_; }
  /// A stop line of a traffic light along the route.
  struct Signal {
    double arc_length = 0.0;  ///< where the light's lane ends [m]
    std::string id;           ///< traffic light
    int link = -1;            ///< position in its state text
  };
  /// The traffic lights along the route, in driving order.
  const std::vector<Signal>& signals() const { return signals_; }
  /// Arc lengths of the stop lines along the route at which right of way is SUMO's 's' (stop sign)
  /// or 'w' (all-way stop): where the lanes before those links end [m].
  const std::vector<double>& stopSigns() const { return stop_signs_; }
  /// Arc lengths where the route changes to a neighboring lane [m].
  const std::vector<double>& laneChanges() const { return lane_changes_; }

 private:
  std::size_t pointIndex(double arc_length) const;
  void noteJunctions();
  void noteEdge(const Lane& lane, double arc_length);
  void noteStep(const RoadNetwork& network, std::size_t i);
  geometry::Polyline path_;
  std::vector<LaneIndex> lanes_;
  std::vector<double> speed_limits_;
  std::vector<bool> in_junction_;
  std::vector<std::string> edges_;
  std::vector<double> edge_starts_;
  std::vector<std::pair<double, double>> junctions_;
  std::vector<Signal> signals_;
  std::vector<double> stop_signs_;
  std::vector<double> lane_changes_;
};

/// The lane of each point by dynamic programming over lanes near it (distance and heading),
/// lane-connected from point to point. Points may lie a few meters apart; their z chooses the level
/// unless every z is 0 in a network with elevation. Throws InputError naming the first point
/// (counted from 0) that is more than 1.5 m off every lane's centerline and outside every lane, or
/// without a route to the next.
Route matchRoute(const RoadNetwork& network, const std::vector<Eigen::Vector3d>& points);

/// How far a vehicle has come along a route: the farthest arc length [m] that it has reached by
/// moving along the route. Each update searches kRouteWindow around the progress so far.
class RouteProgress {
 public:
  /// `route` must outlive the object. 100 % when at least `completion_percent` of the length is
  /// behind and the position is within `completion_distance` [m] of the end.
  explicit RouteProgress(const Route& route, double completion_percent = 99.0,
                         double completion_distance = 10.0);
  /// Takes the vehicle's position, in the map frame [m].
  void update(const Eigen::Vector2d& position);
  /// Farthest arc length so far [m].
  double arcLength() const { return arc_length_; }
  /// Route completion, 0 to 100.
  double percent() const;
  /// Distance of the last position to the route near the progress made [m].
  double deviation() const { return deviation_; }

 private:
  const Route* route_;
  double completion_percent_;
  double completion_distance_;
  double arc_length_ = 0.0;
  double deviation_ = 0.0;
  double distance_to_end_ = 0.0;
};

}  // namespace cdiff::map
