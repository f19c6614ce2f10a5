// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/map/route.h"

namespace cdiff::map {

/// How far a vehicle has come along a route: the farthest arc length [m] that it has reached by
/// moving along the route. Each update searches kRouteWindow around the progress so far.
class RouteProgress {
 public:
  /// `route` must outlive the object. 100 % when at least `completion_percent` of the length is
  /// behind and the position is within `completion_distance` [m] of the end.
  explicit RouteProgress(const Route& route, double completion_percent = 99.0,
                         double completion_distance = 10.0);
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
