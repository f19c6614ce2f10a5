// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/area_outline.h"

#include <cmath>
#include <polyclipping/clipper.hpp>

namespace cdiff::map {
namespace {

constexpr double kUnitsPerMetre = 1000.0;
constexpr double kClosingRadius = 0.15;  // [m] half the widest slit that is closed
constexpr double kLeastHoleArea = 1.0;   // [m^2]
constexpr double kMitreLimit = 2.0;      // longest mitre in strip half-widths

ClipperLib::Path toGrid(const std::vector<Eigen::Vector2d>& points) {
  ClipperLib::Path path;
  path.reserve(points.size());
  for (const Eigen::Vector2d& point : points) {
    path.emplace_back(std::llround(point.x() * kUnitsPerMetre),
                      std::llround(point.y() * kUnitsPerMetre));
  }
  return path;
}

ClipperLib::Paths stripOutline(const Strip& strip) {
  ClipperLib::ClipperOffset offset(kMitreLimit);
  offset.AddPath(toGrid(strip.line), ClipperLib::jtMiter, ClipperLib::etOpenButt);
  ClipperLib::Paths outline;
  offset.Execute(outline, 0.5 * strip.width * kUnitsPerMetre);
  return outline;
}

/// A polygon that may cross itself or run either way round, as simple rings.
ClipperLib::Paths polygonOutline(const Ring& polygon) {
  ClipperLib::Paths outline;
  ClipperLib::SimplifyPolygon(toGrid(polygon), outline, ClipperLib::pftNonZero);
  return outline;
}

ClipperLib::Paths grown(const ClipperLib::Paths& paths, double distance) {
  ClipperLib::ClipperOffset offset(kMitreLimit);
  offset.AddPaths(paths, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
  ClipperLib::Paths result;
  offset.Execute(result, distance * kUnitsPerMetre);
  return result;
}

std::vector<Ring> toRings(const ClipperLib::Paths& paths) {
  constexpr double kLeastHole = kLeastHoleArea * kUnitsPerMetre * kUnitsPerMetre;
  std::vector<Ring> rings;
  for (const ClipperLib::Path& path : paths) {
    const double area = ClipperLib::Area(path);  // negative for holes
    if (path.size() < 3 || (area <= 0.0 && area > -kLeastHole)) continue;
    Ring ring;
    ring.reserve(path.size());
    for (const ClipperLib::IntPoint& point : path) {
      ring.emplace_back(static_cast<double>(point.X) / kUnitsPerMetre,
                        static_cast<double>(point.Y) / kUnitsPerMetre);
    }
    rings.push_back(std::move(ring));
  }
  return rings;
}

}  // namespace

std::vector<Ring> uniteOutlines(const std::vector<Strip>& strips,
                                const std::vector<Ring>& polygons) {
  ClipperLib::Clipper clipper;
  for (const Strip& strip : strips)
    clipper.AddPaths(stripOutline(strip), ClipperLib::ptSubject, true);
  for (const Ring& polygon : polygons) {
    clipper.AddPaths(polygonOutline(polygon), ClipperLib::ptSubject, true);
  }
  ClipperLib::Paths united;
  clipper.Execute(ClipperLib::ctUnion, united, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  return toRings(grown(grown(united, kClosingRadius), -kClosingRadius));
}

}  // namespace cdiff::map
