// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

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

/// Where a point lies relative to a polyline.
struct Projection {
  double arc_length = 0.0;  ///< arc length at the nearest point [m]
  double lateral_offset =
      0.0;                 ///< signed distance to the line's direction there, positive left [m]
  double distance = 0.0;   ///< to the nearest point, in the plane [m]
  double elevation = 0.0;  ///< elevation at the nearest point [m]
  double heading = 0.0;    ///< heading at the nearest segment [rad]
};

/// Part of a line around an arc length, in which a vehicle is looked for that was there before [m].
struct SearchWindow {
  double behind = 0.0;  ///< how far before that arc length
  double ahead = 0.0;   ///< how far beyond it
};

/// A line through points (x, y, z) in the map frame [m], parametrized by its arc length in the
/// plane [m].
class Polyline {
 public:
  Polyline() = default;
  /// Neighboring points nearer than 1 mm in the plane are merged. Throws InputError with fewer than
  /// two distinct points or a non-finite coordinate.
  explicit Polyline(const std::vector<Eigen::Vector3d>& points);

  /// Its points, without the merged ones.
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  /// Arc length of each point [m].
  const std::vector<double>& arcLengths() const { return arc_lengths_; }
  /// Whether it was made without points.
  bool empty() const { return points_.empty(); }
  /// Arc length of its end [m].
  double length() const { return arc_lengths_.empty() ? 0.0 : arc_lengths_.back(); }

  /// Point at an arc length, clamped to the ends.
  Eigen::Vector3d pointAt(double arc_length) const;
  /// The same without elevation.
  Eigen::Vector2d positionAt(double arc_length) const { return pointAt(arc_length).head<2>(); }
  /// Heading of the segment at an arc length, clamped to the ends [rad].
  double headingAt(double arc_length) const;
  /// Point and heading at an arc length; before its start and beyond its end the line goes straight
  /// on.
  Pose2d extendedPoseAt(double arc_length) const;
  /// Nearest point of the line; the first of equals.
  Projection project(const Eigen::Vector2d& point) const;
  /// Nearest point among those with an arc length in [begin, end].
  Projection project(const Eigen::Vector2d& point, double begin, double end) const;
  /// First and last arc length of the window around `arc_length`, clamped to the ends.
  std::pair<double, double> around(double arc_length, const SearchWindow& window) const;
  /// Nearest point among those in the window around `arc_length`.
  Projection projectNear(const Eigen::Vector2d& point, double arc_length,
                         const SearchWindow& window) const;
  /// The part between two arc lengths (end > begin).
  Polyline slice(double begin, double end) const;
  /// Points every `spacing` meters from the start, the end included.
  std::vector<Eigen::Vector3d> resampled(double spacing) const;

 private:
  std::size_t segmentAt(double arc_length) const;
  std::vector<Eigen::Vector3d> points_;
  std::vector<double> arc_lengths_;
};

}  // namespace cdiff::geometry
