// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/map/road_network.h"
#include "rendering/road_scene.h"

namespace cdiff::rendering {

// Borders of a lane: points beside its centerline that join without gaps at bends.

/// A cross-section of a lane (map frame [m]).
struct CrossSection {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector2d left = Eigen::Vector2d::Zero();  ///< to 1 m left of the line; longer at bends
  double arc_length = 0.0;                         ///< [m]

  /// The point `lateral` meters to the left.
  Eigen::Vector3d at(double lateral) const {
    return {center.x() + lateral * left.x(), center.y() + lateral * left.y(), center.z()};
  }
};

/// Cross-sections at the arc lengths `begin` and `end` [m], at every point of the line between
/// them, and at enough others that neighbors are at most `spacing` [m] apart.
std::vector<CrossSection> crossSections(const geometry::Polyline& line, double begin, double end,
                                        double spacing);

// The markings of a network's lanes: solid white lines at the road's edges, dashed white ones
// between lanes of one direction, solid yellow ones beside lanes of the other direction.

/// The kind of a piece of a lane's outer border: the road's edge, the centerline toward lanes of
/// the opposite direction, or none (it lies on another lane).
enum class Border { kEdge, kCenter, kNone };

/// The kind of border at `point` (map frame [m]), which lies on it; `heading` is the lane's there
/// [rad].
Border borderAt(const map::RoadNetwork& network, const map::Lane& lane,
                const Eigen::Vector3d& point, double heading);

/// All markings of the network.
std::vector<Marking> laneMarkings(const map::RoadNetwork& network);

/// The sides of roads that lie above their surroundings: grass slopes down to the lowest road
/// nearby, or the sides of a bridge's deck where a lower road is in the way.
std::vector<Surface> roadSides(const map::RoadNetwork& network);

}  // namespace cdiff::rendering
