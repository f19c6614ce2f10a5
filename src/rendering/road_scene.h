// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "rendering/canvas.h"
#include "rendering/spatial_grid.h"

namespace cdiff::rendering {

// Triangles of a simple polygon by cutting ears off, in the plane; heights are kept.

/// Triangles that fill the outline (either turning direction); a rest that is not simple is filled
/// as a fan.
std::vector<std::array<Eigen::Vector3d, 3>> triangulate(std::vector<Eigen::Vector3d> outline);

/// A flat piece of ground (map frame [m]).
struct Surface {
  std::array<Eigen::Vector3d, 4> corners;
  int count = 4;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< normal, not of unit length
  Color color = kAsphalt;
  double rank = rank::kRoad;
  bool two_sided = false;  ///< the same color from below
};

/// A painted line (map frame [m]).
struct Marking {
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  Eigen::Vector3d side = Eigen::Vector3d::Zero();  ///< half its width to the left
  Color color = kWhitePaint;
};

/// What lies on the ground and never changes: asphalt of lanes and junctions, pavements, markings;
/// computed once from the network, drawn where a view may see it.
class RoadScene {
 public:
  explicit RoadScene(const map::RoadNetwork& network);
  void draw(const View& view, Canvas& canvas);

 private:
  void drawSurface(const Surface& surface, const View& view, Canvas& canvas) const;

  /// Farthest first: thin lines are transparent.
  void sortMarkings(const View& view);

  std::vector<Surface> surfaces_;
  std::vector<Marking> markings_;
  SpatialGrid surface_grid_;
  SpatialGrid marking_grid_;
  std::vector<int> visible_;                         ///< buffer of draw
  std::vector<std::pair<double, int>> by_distance_;  ///< buffer of sortMarkings
};

/// Draws a painted line if it is seen from above.
void drawMarking(const Marking& marking, double rank, const View& view, Canvas& canvas);

/// A painted line between two points, `width` wide [m].
Marking markingBetween(const Eigen::Vector3d& begin, const Eigen::Vector3d& end, double width,
                       Color color);

}  // namespace cdiff::rendering
