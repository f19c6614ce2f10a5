// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace cdiff::geometry {

/// Unit vector along a heading.
inline Eigen::Vector2d direction(double heading) { return {std::cos(heading), std::sin(heading)}; }

/// Vector turned by +90 degrees.
inline Eigen::Vector2d leftNormal(const Eigen::Vector2d& vector) {
  return {-vector.y(), vector.x()};
}

/// z component of the cross product; positive when `second` lies left of `first`.
inline double cross(const Eigen::Vector2d& first, const Eigen::Vector2d& second) {
  return first.x() * second.y() - first.y() * second.x();
}

/// Position and heading in the plane of the map frame (x east, y north [m]; heading
/// counter-clockwise from +x [rad]).
struct Pose2d {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  double heading = 0.0;                                ///< [rad]

  /// A map point in this pose's body frame (x forward, y left).
  Eigen::Vector2d toBody(const Eigen::Vector2d& map_point) const {
    const Eigen::Vector2d forward = direction(heading);
    const Eigen::Vector2d offset = map_point - position;
    return {forward.dot(offset), leftNormal(forward).dot(offset)};
  }
  /// A body-frame point in the map frame.
  Eigen::Vector2d toMap(const Eigen::Vector2d& body_point) const {
    const Eigen::Vector2d forward = direction(heading);
    return position + forward * body_point.x() + leftNormal(forward) * body_point.y();
  }
};

}  // namespace cdiff::geometry
