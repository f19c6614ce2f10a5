// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/simplified.h"
#include "record/session_result.h"

namespace cdiff::page {

// Lines and rings cut to a rectangle and thinned, in the map frame [m], so that a picture holds
// only what it shows.

/// An upright rectangle.
struct Region {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();   ///< [m]
  Eigen::Vector2d high = Eigen::Vector2d::Zero();  ///< [m]

  bool contains(const Eigen::Vector2d& point) const;
  /// Larger by `margin` on every side [m].
  Region grown(double margin) const;
};

using Points = std::vector<Eigen::Vector2d>;

using geometry::simplified;

/// Stretches of the line whose segments may cross the region (their bounding boxes touch it).
std::vector<Points> stretchesIn(const Points& line, const Region& region);

/// The part of a ring inside the region (Sutherland and Hodgman 1974); empty when nothing is left.
Points clippedRing(const Points& ring, const Region& region);

/// x and y of points in space.
Points inPlane(const std::vector<Eigen::Vector3d>& points);

/// The part of the map that the picture from above shows, and its pixels: x right, y down, from the
/// top left corner.
class MapCanvas {
 public:
  /// Shows `content` and fills the width of the page.
  explicit MapCanvas(const Region& content);
  /// Shows `content` in the middle of a picture of `size` (width, height) [pixels].
  MapCanvas(const Region& content, const Eigen::Vector2d& size);

  const Region& region() const { return region_; }
  double scale() const { return scale_; }  ///< [pixels / m]
  double width() const;                    ///< [pixels]
  double height() const;                   ///< [pixels]
  Eigen::Vector2d toPixels(const Eigen::Vector2d& position) const;
  /// Whether anything at this position would show.
  bool shows(const Eigen::Vector2d& position) const;
  /// Path data (attribute d) of a line, cut to the picture and thinned to 0.15 m; empty when
  /// nothing of it shows.
  std::string line(const Points& points) const;
  /// Path data of a closed ring, cut and thinned likewise.
  std::string ring(const Points& points) const;

 private:
  std::string data(const Points& points) const;
  Region region_;
  double scale_ = 1.0;
};

/// The ego route and the trails of ego and CBVs with a margin of 25 m.
Region sessionRegion(const record::SessionResult& result);

}  // namespace cdiff::page
