// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Lines and rings cut to a rectangle and thinned, in the map frame [m], so that a picture holds
/// only what it shows.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace cdiff::page {

/// An upright rectangle.
struct Region {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();   ///< [m]
  Eigen::Vector2d high = Eigen::Vector2d::Zero();  ///< [m]

  bool contains(const Eigen::Vector2d& point) const;
  /// Larger by `margin` on every side [m].
  Region grown(double margin) const;
};

using Points = std::vector<Eigen::Vector2d>;

/// The line without points that lie nearer than `tolerance` [m] to it (Douglas and Peucker 1973).
Points simplified(const Points& line, double tolerance);

/// Stretches of the line whose segments may cross the region (their bounding boxes touch it).
std::vector<Points> stretchesIn(const Points& line, const Region& region);

/// The part of a ring inside the region (Sutherland and Hodgman 1974); empty when nothing is left.
Points clippedRing(const Points& ring, const Region& region);

/// x and y of points in space.
Points inPlane(const std::vector<Eigen::Vector3d>& points);

}  // namespace cdiff::page
