// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/triangulation.h"

#include <algorithm>
#include <cstddef>

namespace cdiff::rendering {
namespace {

/// Twice the signed area of a triangle, positive when counter-clockwise.
double turn(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool holds(const std::array<Eigen::Vector3d, 3>& triangle, const Eigen::Vector3d& point) {
  return turn(triangle[0], triangle[1], point) >= 0.0 &&
         turn(triangle[1], triangle[2], point) >= 0.0 &&
         turn(triangle[2], triangle[0], point) >= 0.0;
}

bool isEar(const std::vector<Eigen::Vector3d>& ring, std::size_t at) {
  const std::size_t before = (at + ring.size() - 1) % ring.size();
  const std::size_t after = (at + 1) % ring.size();
  const std::array<Eigen::Vector3d, 3> triangle = {ring[before], ring[at], ring[after]};
  if (turn(triangle[0], triangle[1], triangle[2]) <= 0.0) return false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (i == before || i == at || i == after) continue;
    if (turn(ring[(i + ring.size() - 1) % ring.size()], ring[i], ring[(i + 1) % ring.size()]) >=
        0.0)
      continue;  // only a corner that bends inwards can lie in an ear
    if (holds(triangle, ring[i])) return false;
  }
  return true;
}

void dropRepeated(std::vector<Eigen::Vector3d>& ring) {
  const auto same = [](const Eigen::Vector3d& left, const Eigen::Vector3d& right) {
    return (left - right).head<2>().squaredNorm() < 1e-6;
  };
  ring.erase(std::unique(ring.begin(), ring.end(), same), ring.end());
  while (ring.size() > 1 && same(ring.front(), ring.back())) ring.pop_back();
}

}  // namespace

std::vector<std::array<Eigen::Vector3d, 3>> triangulate(std::vector<Eigen::Vector3d> outline) {
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;
  dropRepeated(outline);
  if (outline.size() < 3) return triangles;
  double area = 0.0;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    area += turn(outline[0], outline[i], outline[i + 1]);
  }
  if (area < 0.0) std::reverse(outline.begin(), outline.end());
  while (outline.size() > 3) {
    std::size_t ear = 0;
    while (ear < outline.size() && !isEar(outline, ear)) ++ear;
    if (ear == outline.size()) break;
    triangles.push_back({outline[(ear + outline.size() - 1) % outline.size()], outline[ear],
                         outline[(ear + 1) % outline.size()]});
    outline.erase(outline.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    triangles.push_back({outline[0], outline[i], outline[i + 1]});
  }
  return triangles;
}

}  // namespace cdiff::rendering
