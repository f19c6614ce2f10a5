// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The part of the map that the picture from above shows, and its pixels: x right, y down, from the
/// top left corner.
#pragma once

#include <string>

#include "page/picture_geometry.h"
#include "record/session_result.h"

namespace cdiff::page {

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
