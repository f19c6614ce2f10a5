// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "e2e_cdiff/geometry/pose.h"

namespace cdiff::geometry {

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
  double behind = 0.0;
  double ahead = 0.0;
};

/// A line through points (x, y, z) in the map frame [m], parametrized by its arc length in the
/// plane [m].
class Polyline {
 public:
  Polyline() = default;
  /// Neighboring points nearer than 1 mm in the plane are merged. Throws InputError with fewer
  /// than two distinct points or a non-finite coordinate.
  explicit Polyline(const std::vector<Eigen::Vector3d>& points);

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  /// Arc length of each point [m].
  const std::vector<double>& arcLengths() const { return arc_lengths_; }
  bool empty() const { return points_.empty(); }
  double length() const { return arc_lengths_.empty() ? 0.0 : arc_lengths_.back(); }

  /// Point at an arc length, clamped to the ends.
  Eigen::Vector3d pointAt(double arc_length) const;
  Eigen::Vector2d positionAt(double arc_length) const { return pointAt(arc_length).head<2>(); }
  /// Heading of the segment at an arc length, clamped to the ends [rad].
  double headingAt(double arc_length) const;
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
