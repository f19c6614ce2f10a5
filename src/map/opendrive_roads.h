// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::map {

/// A place in the coordinates of a road: s along its reference line and t to the left of it [m].
struct RoadPlace {
  std::string road;  ///< id of the road
  int lane = 0;      ///< id of the lane: negative to the right of the reference line
  double s = 0.0;    ///< [m]
  double t = 0.0;    ///< [m]
};

/// The roads of an OpenDRIVE file as its reference lines and lane widths describe them, in the
/// file's own coordinates (x east, y north [m]; heading counter-clockwise [rad]). SUMO's lanes of
/// the same file differ by some decimeters.
class OpenDriveRoads {
 public:
  /// `name` is used in errors. Throws InputError naming the road and what was expected.
  OpenDriveRoads(const std::string& text, const std::string& name);
  OpenDriveRoads(OpenDriveRoads&&) noexcept;             ///< move
  OpenDriveRoads& operator=(OpenDriveRoads&&) noexcept;  ///< move
  ~OpenDriveRoads();

  /// The point at s and t of a road, with the road's heading there and its elevation. Throws
  /// InputError for an unknown road and an s beyond its ends.
  geometry::Pose2d poseAt(const std::string& road, double s, double t) const;
  /// Elevation of a road at s [m]. Throws as poseAt.
  double elevationAt(const std::string& road, double s) const;
  /// t of the center of a lane at s [m]. Throws as poseAt, and for an unknown lane.
  double laneCenter(const std::string& road, int lane, double s) const;
  /// The lane that a point lies on, whose road is nearest in elevation and then in heading to
  /// `heading`; nullopt off every lane.
  std::optional<RoadPlace> locate(const Eigen::Vector2d& point, double elevation,
                                  double heading) const;

 private:
  struct Road;
  const Road& roadOf(const std::string& id) const;
  const Road& roadAt(const std::string& id, double s) const;
  std::string name_;
  std::map<std::string, std::unique_ptr<const Road>> roads_;  ///< by id
};

}  // namespace cdiff::map
