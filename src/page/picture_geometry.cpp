// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/picture_geometry.h"

#include <algorithm>
#include <utility>

namespace cdiff::page {
namespace {

double distanceToSegment(const Eigen::Vector2d& point, const Eigen::Vector2d& begin,
                         const Eigen::Vector2d& end) {
  const Eigen::Vector2d along = end - begin;
  const double squared = along.squaredNorm();
  const double share =
      squared > 0.0 ? std::clamp((point - begin).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (point - begin - share * along).norm();
}

/// Index of the point between two others that is farthest from their segment, with the distance.
std::pair<std::size_t, double> farthest(const Points& line, std::size_t begin, std::size_t end) {
  std::pair<std::size_t, double> result{begin, -1.0};
  for (std::size_t i = begin + 1; i < end; ++i) {
    const double distance = distanceToSegment(line[i], line[begin], line[end]);
    if (distance > result.second) result = {i, distance};
  }
  return result;
}

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

Points simplified(const Points& line, double tolerance) {
  if (line.size() < 3) return line;
  std::vector<bool> kept(line.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open = {{0, line.size() - 1}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    const auto [index, distance] = farthest(line, begin, end);
    if (distance <= tolerance) continue;
    kept[index] = true;
    open.emplace_back(begin, index);
    open.emplace_back(index, end);
  }
  Points result;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (kept[i]) result.push_back(line[i]);
  }
  return result;
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

}  // namespace cdiff::page
