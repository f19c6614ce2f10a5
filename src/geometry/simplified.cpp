// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "geometry/simplified.h"

#include <algorithm>
#include <utility>

namespace cdiff::geometry {
namespace {

using Points = std::vector<Eigen::Vector2d>;

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

}  // namespace

std::vector<Eigen::Vector2d> simplified(const std::vector<Eigen::Vector2d>& line,
                                        double tolerance) {
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

}  // namespace cdiff::geometry
