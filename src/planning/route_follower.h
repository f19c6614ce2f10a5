// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planning {

/// Arc length of the point nearest to `position` on the extended route, among those with arc
/// lengths in [begin, end].
double extendedProjection(const map::Route& route, const Eigen::Vector2d& position, double begin,
                          double end);

/// Where a vehicle is on its route: arc length [m] that only grows, found near the one before, so
/// that a route that crosses itself or comes back is followed in order. Before its start and beyond
/// its end the route goes straight on. (Completion by a protocol's rule: map::RouteProgress, which
/// starts at the route's begin; a path that may be left and found again: cbv::advancedArcLength.)
/// Holds no reference: the route is given at each call and may be another object with the same
/// content.
class RouteFollower {
 public:
  /// Moves to `position`: at most as far as kRouteWindow, or `reach` where that is more, ahead of
  /// the last arc length. Starts again when the route is not the one of the last call: at its first
  /// 20 m if they pass within 3 m, else at its nearest point.
  void update(const map::Route& route, const Eigen::Vector2d& position, double reach = 0.0);
  /// Farthest arc length so far [m]; may exceed the route's length.
  double arcLength() const { return arc_length_; }

 private:
  bool knows(const map::Route& route) const;
  void start(const map::Route& route, const Eigen::Vector2d& position);

  double arc_length_ = 0.0;
  // The route of the last call, identified by its size, length and ends.
  std::size_t point_count_ = 0;
  double length_ = 0.0;
  Eigen::Vector3d first_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
};

/// Where the ego is on its route, for planners that are not called at decisions without a CBV: it
/// may have come as far since as 40 m/s take it.
class EgoFollower {
 public:
  /// Moves to the ego of the snapshot, which must have one with a finite state. `simulation_step`
  /// [s] is the time between ticks.
  void update(const map::Route& route, const traffic::TrafficSnapshot& snapshot,
              double simulation_step);
  /// As RouteFollower's [m].
  double arcLength() const { return follower_.arcLength(); }

 private:
  RouteFollower follower_;
  std::uint64_t tick_ = 0;  ///< of the last call
};

}  // namespace cdiff::planning
