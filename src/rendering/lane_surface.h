// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "rendering/road_scene.h"

namespace cdiff::rendering {

// Borders of a lane: points beside its centerline that fit together at bends.

/// A cross-section of a lane.
struct CrossSection {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector2d left = Eigen::Vector2d::Zero();  ///< where 1 m to the left lies, at bends longer
  double arc_length = 0.0;                         ///< [m]

  /// The point `lateral` meters to the left.
  Eigen::Vector3d at(double lateral) const {
    return {center.x() + lateral * left.x(), center.y() + lateral * left.y(), center.z()};
  }
};

/// Cross-sections from arc length `begin` to `end`: both, every point of the line between them, and
/// more so that neighbors are at most `spacing` apart.
std::vector<CrossSection> crossSections(const geometry::Polyline& line, double begin, double end,
                                        double spacing);

// The markings of a network's lanes: solid white lines at the road's edges, dashed white ones
// between lanes of one direction, solid yellow ones beside lanes of the other direction.

/// What a piece of a lane's outer border is: the road's edge, the centerline to the lanes of the
/// other direction, or nothing (it lies on another lane).
enum class Border { kEdge, kCenter, kNone };

/// `point` lies on the border, `heading` is the lane's there.
Border borderAt(const map::RoadNetwork& network, const map::Lane& lane,
                const Eigen::Vector3d& point, double heading);

std::vector<Marking> laneMarkings(const map::RoadNetwork& network);

/// What stands beside roads that lie higher than their surroundings: grass slopes down to the
/// lowest road near, or the side of a bridge's deck where a lower road is in the way.
std::vector<Surface> roadSides(const map::RoadNetwork& network);

}  // namespace cdiff::rendering
