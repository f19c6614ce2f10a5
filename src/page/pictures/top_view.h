// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/markup.h"
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

// The session from above as one SVG element: drivable area, lanes, ego route, conflicts, trails,
// vehicles at the final tick. Names in it are cut to 40 characters; tool tips hold them whole.

core::Markup topViewSvg(const record::SessionResult& result, const MapCanvas& canvas);

/// Drivable area and lanes alone.
core::Markup roadSvg(const session::SessionSetup& setup, const MapCanvas& canvas);

/// A vehicle's box, `magnification` times as large as it is, of a CSS class.
core::Markup vehicleSvg(const record::TimelineVehicle& vehicle, const geometry::Pose2d& pose,
                        const MapCanvas& canvas, const std::string& style,
                        double magnification = 1.0);

/// A bar of a round length and the direction of north, in the lower corners and at the top right.
core::Markup scaleBarSvg(const MapCanvas& canvas);

/// Its legend, as HTML, with the lines of attentionSvg and what perceivedSvg draws where `timeline`
/// has any.
core::Markup topViewLegend(const MapCanvas& canvas, const record::Timeline* timeline = nullptr);

/// Whether any planner of the session said what it looked at.
bool showsAttention(const record::Timeline& timeline);

/// Lines from drivers to the vehicles that they look at in the last frame, as thick and dark as
/// they do; empty where no planner of the session says so.
core::Markup attentionSvg(const record::Timeline& timeline, const MapCanvas& canvas);

/// One thing that the ego's planner believes to see, as a path of a CSS class and an opacity.
struct PerceivedPath {
  std::string style;
  double opacity = 1.0;
  std::string data;
};
/// All of a frame: occupied cells (the later the fainter), lines of the road by kind, the likeliest
/// way and the box of each vehicle (opaque by score).
std::vector<PerceivedPath> perceivedPaths(const planning::Perception& perception,
                                          const MapCanvas& canvas);

/// Whether the ego's planner said what it believes to see.
bool showsPerception(const record::Timeline& timeline);

/// perceivedPaths of the last frame that has any; empty where the planner never says so.
core::Markup perceivedSvg(const record::Timeline& timeline, const MapCanvas& canvas);

/// Factor by which vehicles are drawn larger than they are, so that they can be seen; 1 when the
/// scale allows.
double vehicleMagnification(const MapCanvas& canvas);

/// CSS class of a vehicle in pictures and charts: "ego", "bg", or "cbv c0" to "cbv c4" by order of
/// selection.
std::string styleOf(traffic::VehicleRole role, const std::string& id, const record::CbvLog& cbv);

}  // namespace cdiff::page
