// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/map_canvas.h"

#include <algorithm>

#include "page/pictures/charts.h"

namespace cdiff::page {
namespace {

bool segmentMayCross(const Eigen::Vector2d& begin, const Eigen::Vector2d& end,
                     const Region& region) {
  return std::min(begin.x(), end.x()) <= region.high.x() &&
         std::max(begin.x(), end.x()) >= region.low.x() &&
         std::min(begin.y(), end.y()) <= region.high.y() &&
         std::max(begin.y(), end.y()) >= region.low.y();
}

/// The half plane sign * coordinate <= sign * limit.
struct Side {
  Eigen::Index axis;
  double limit;
  double sign;

  bool inside(const Eigen::Vector2d& point) const { return sign * (point[axis] - limit) <= 0.0; }
  Eigen::Vector2d crossing(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
    const double share = (limit - from[axis]) / (to[axis] - from[axis]);
    return from + share * (to - from);
  }
};

Points clippedAt(const Points& ring, const Side& side) {
  Points kept;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& present = ring[i];
    const Eigen::Vector2d& previous = ring[(i + ring.size() - 1) % ring.size()];
    if (side.inside(present) != side.inside(previous)) {
      kept.push_back(side.crossing(previous, present));
    }
    if (side.inside(present)) kept.push_back(present);
  }
  return kept;
}

}  // namespace

bool Region::contains(const Eigen::Vector2d& point) const {
  return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
}

Region Region::grown(double margin) const {
  const Eigen::Vector2d offset(margin, margin);
  return {low - offset, high + offset};
}

std::vector<Points> stretchesIn(const Points& line, const Region& region) {
  std::vector<Points> stretches;
  bool open = false;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const bool crosses = segmentMayCross(line[i - 1], line[i], region);
    if (crosses && !open) stretches.push_back({line[i - 1]});
    if (crosses) stretches.back().push_back(line[i]);
    open = crosses;
  }
  return stretches;
}

Points clippedRing(const Points& ring, const Region& region) {
  const Side sides[] = {{0, region.high.x(), 1.0},
                        {0, region.low.x(), -1.0},
                        {1, region.high.y(), 1.0},
                        {1, region.low.y(), -1.0}};
  Points kept = ring;
  for (const Side& side : sides) kept = clippedAt(kept, side);
  return kept;
}

Points inPlane(const std::vector<Eigen::Vector3d>& points) {
  Points plane;
  plane.reserve(points.size());
  for (const Eigen::Vector3d& point : points) plane.emplace_back(point.x(), point.y());
  return plane;
}

namespace {

constexpr double kWidth = 1100.0;         // [pixels]
constexpr double kLargestHeight = 720.0;  // [pixels]
constexpr double kLeastHeight = 380.0;    // [pixels]
constexpr double kMargin = 25.0;          // around what the session touched [m]
constexpr double kOverhang =
    20.0;  // beyond the picture's edge, so that cut borders do not show [m]
constexpr double kTolerance = 0.15;  // of thinned lines [m]

void include(Region& region, const Eigen::Vector2d& point) {
  region.low = region.low.cwiseMin(point);
  region.high = region.high.cwiseMax(point);
}

}  // namespace

MapCanvas::MapCanvas(const Region& content) {
  const Eigen::Vector2d size = (content.high - content.low).cwiseMax(Eigen::Vector2d(1.0, 1.0));
  scale_ = std::min(kWidth / size.x(), kLargestHeight / size.y());
  const Eigen::Vector2d shown(kWidth / scale_, std::max(size.y(), kLeastHeight / scale_));
  const Eigen::Vector2d center = 0.5 * (content.low + content.high);
  region_ = {center - 0.5 * shown, center + 0.5 * shown};
}

MapCanvas::MapCanvas(const Region& content, const Eigen::Vector2d& size) {
  const Eigen::Vector2d wanted = (content.high - content.low).cwiseMax(Eigen::Vector2d(1.0, 1.0));
  scale_ = size.cwiseQuotient(wanted).minCoeff();
  const Eigen::Vector2d center = 0.5 * (content.low + content.high);
  region_ = {center - 0.5 / scale_ * size, center + 0.5 / scale_ * size};
}

double MapCanvas::width() const { return (region_.high.x() - region_.low.x()) * scale_; }

double MapCanvas::height() const { return (region_.high.y() - region_.low.y()) * scale_; }

Eigen::Vector2d MapCanvas::toPixels(const Eigen::Vector2d& position) const {
  return {(position.x() - region_.low.x()) * scale_, (region_.high.y() - position.y()) * scale_};
}

bool MapCanvas::shows(const Eigen::Vector2d& position) const {
  constexpr double kVehicleReach = 8.0;  // [m]
  return region_.grown(kVehicleReach).contains(position);
}

std::string MapCanvas::line(const Points& points) const {
  std::string path;
  for (const Points& stretch : stretchesIn(points, region_.grown(kOverhang))) {
    path += data(simplified(stretch, kTolerance));
  }
  return path;
}

std::string MapCanvas::ring(const Points& points) const {
  const Points kept = simplified(clippedRing(points, region_.grown(kOverhang)), kTolerance);
  return kept.size() < 3 ? std::string() : data(kept) + "Z";
}

std::string MapCanvas::data(const Points& points) const {
  std::string text;
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d pixel = toPixels(point);
    text += (text.empty() ? 'M' : 'L') + svgPlace(pixel.x(), pixel.y());
  }
  return text;
}

Region sessionRegion(const record::SessionResult& result) {
  const auto& route = result.setup.egoRoute().path().points();
  const Eigen::Vector2d first =
      route.empty() ? Eigen::Vector2d::Zero() : Eigen::Vector2d(route.front().head<2>());
  Region region{first, first};
  for (const Eigen::Vector3d& point : route) include(region, point.head<2>());
  for (const record::TimelineFrame& frame : result.timeline.frames()) {
    for (const record::TimelinePose& pose : frame.poses) {
      if (pose.role != traffic::VehicleRole::kBackground) include(region, {pose.x, pose.y});
    }
  }
  return region.grown(kMargin);
}

}  // namespace cdiff::page
