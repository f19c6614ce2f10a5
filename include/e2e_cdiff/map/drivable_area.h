// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "e2e_cdiff/map/road_network.h"

namespace cdiff::map {

/// Signed distance and its gradient in the plane.
struct SignedDistance {
  double distance = 0.0;  ///< [m], positive inside, zero on the border
  Eigen::Vector2d gradient =
      Eigen::Vector2d::Zero();  ///< unit vector of steepest increase (toward the inside)
};

/// The drivable area: union of the outlines of lanes that allow cars and of junctions, in levels of
/// elevation, with the signed distance to its border [m], positive inside, and its gradient.
class DrivableArea {
 public:
  /// Throws InputError for a network without a lane that allows cars.
  explicit DrivableArea(const RoadNetwork& network);
  DrivableArea(DrivableArea&&) noexcept;             ///< move
  DrivableArea& operator=(DrivableArea&&) noexcept;  ///< move
  ~DrivableArea();

  /// Exact distance to the border of the area on the level of `elevation` [m].
  double signedDistance(const Eigen::Vector2d& position, double elevation = 0.0) const;
  /// The smallest of a box's corners, all on the level of `elevation` [m].
  double signedDistance(const geometry::OrientedBox& box, double elevation = 0.0) const;
  /// That of a point, with its gradient.
  SignedDistance signedDistanceWithGradient(const Eigen::Vector2d& position,
                                            double elevation = 0.0) const;
  /// Whether a point lies on the area.
  bool contains(const Eigen::Vector2d& position, double elevation = 0.0) const;
  /// Border rings of the level nearest to an elevation (outer rings and holes), for drawing.
  std::vector<std::vector<Eigen::Vector2d>> border(double elevation = 0.0) const;
  /// Number of levels.
  std::size_t levelCount() const;

 private:
  struct Level;
  const Level& levelAt(double elevation) const;
  std::vector<std::unique_ptr<Level>> levels_;
};

}  // namespace cdiff::map
