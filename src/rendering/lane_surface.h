// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Borders of a lane: points beside its centre line that fit together at bends.
#pragma once

#include <vector>

#include "e2e_cdiff/geometry/polyline.h"

namespace cdiff::rendering {

/// A cross-section of a lane.
struct CrossSection {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector2d left = Eigen::Vector2d::Zero();  ///< where 1 m to the left lies, at bends longer
  double arc_length = 0.0;                         ///< [m]

  /// The point `lateral` metres to the left.
  Eigen::Vector3d at(double lateral) const {
    return {center.x() + lateral * left.x(), center.y() + lateral * left.y(), center.z()};
  }
};

/// Cross-sections from arc length `begin` to `end`: both, every point of the line between them, and
/// more so that neighbours are at most `spacing` apart.
std::vector<CrossSection> crossSections(const geometry::Polyline& line, double begin, double end,
                                        double spacing);

}  // namespace cdiff::rendering
