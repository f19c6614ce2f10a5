// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::reference_driver {

/// Another vehicle in the coordinates of a driver's path (SI units; offsets positive left).
struct SeenVehicle {
  std::uint64_t id = 0;       ///< hash of the vehicle's id
  double arc_length = 0.0;    ///< of its center [m]
  double offset = 0.0;        ///< of its center from the path [m]
  double along_speed = 0.0;   ///< [m/s]; negative: toward the path's start
  double across_speed = 0.0;  ///< [m/s]
  double acceleration = 0.0;  ///< along its own heading [m/s^2]
  double half_along = 0.0;    ///< half of its box along the path [m]
  double half_across = 0.0;   ///< and across [m]
};

/// The driver's own motion on its path.
struct OwnMotion {
  double time = 0.0;          ///< [s]
  double arc_length = 0.0;    ///< of its center [m]
  double offset = 0.0;        ///< of its center from the path; kept [m]
  double speed = 0.0;         ///< [m/s]
  double acceleration = 0.0;  ///< over the last tick [m/s^2]
  traffic::VehicleDimensions dimensions;
};

/// The part of a route that a driver may come along, as points 1 m apart, so that places and
/// projections cost next to nothing (map frame).
class DrivenPath {
 public:
  /// From 30 m before `arc_length` of `line` to `ahead` beyond it; straight on beyond the ends.
  DrivenPath(const geometry::Polyline& line, double arc_length, double ahead);

  /// Clamped to the ends.
  geometry::Pose2d poseAt(double arc_length) const;
  /// Box of a driver at a place of its path.
  geometry::OrientedBox boxOf(const OwnMotion& own) const;
  /// A vehicle as seen along the path; `hint` is where its nearest point was, and becomes where it
  /// is. nullopt beyond the ends, where the path says nothing of it.
  std::optional<SeenVehicle> see(const traffic::VehicleState& state,
                                 const traffic::VehicleDimensions& dimensions,
                                 std::optional<std::size_t>& hint) const;

 private:
  std::size_t nearest(const Eigen::Vector2d& place, std::optional<std::size_t> hint) const;

  double start_ = 0.0;  ///< arc length of the first point [m]
  std::vector<geometry::Pose2d> poses_;
};

}  // namespace cdiff::reference_driver
