// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>

#include "e2e_cdiff/geometry/pose.h"

namespace cdiff::geometry {

/// Outline of a vehicle in the plane: a rectangle with center [m], heading [rad], length and width
/// [m].
struct OrientedBox {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< [m], map frame
  double heading = 0.0;                              ///< [rad]
  double length = 0.0;                               ///< [m]
  double width = 0.0;                                ///< [m]

  /// Corners in the order front-left, front-right, rear-right, rear-left: a proper ring, clockwise.
  std::array<Eigen::Vector2d, 4> corners() const;
  /// Whether a point lies inside or on the border.
  bool contains(const Eigen::Vector2d& point) const;
};

/// Half the extent of a box along a unit axis of the map frame [m].
double halfExtent(const OrientedBox& box, const Eigen::Vector2d& axis);

/// Whether two boxes share at least a point (separating axes).
bool overlap(const OrientedBox& first, const OrientedBox& second);

/// Shortest distance between two boxes [m]; 0 when they overlap.
double distance(const OrientedBox& first, const OrientedBox& second);

}  // namespace cdiff::geometry
