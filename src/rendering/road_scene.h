// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/map/road_network.h"
#include "rendering/canvas.h"

namespace cdiff::rendering {

/// A sphere that encloses a surface or marking (map frame [m]).
struct Bound {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// The sphere around the points' axis-aligned bounding box.
Bound boundOf(const Eigen::Vector3d* points, int count);

/// Finds what a view may see: bounding spheres, sorted into square cells by their centers.
class SpatialGrid {
 public:
  SpatialGrid() = default;
  explicit SpatialGrid(std::vector<Bound> bounds);

  /// Indices of the things that each view may see, cell by cell, in the order of the cells and
  /// indices; `found` gets one list per view.
  void visible(const std::vector<View>& views, std::vector<std::vector<int>>& found) const;

 private:
  void sortIntoCells();
  void boundCells();
  std::size_t cellOf(const Eigen::Vector3d& point) const;
  /// Columns and rows, all included.
  struct CellRange {
    int first_column = 0;
    int last_column = -1;
    int first_row = 0;
    int last_row = -1;
  };
  /// The cells that hold all that the views may see.
  CellRange cellsAround(const std::vector<View>& views) const;
  void visibleIn(std::size_t cell, const View& view, std::vector<int>& found) const;
  std::vector<Bound> bounds_;
  std::vector<int> items_;               ///< indices of spheres, by cell
  std::vector<std::size_t> cell_begin_;  ///< first item of each cell in items_, then their number
  std::vector<Bound> cell_bounds_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int columns_ = 0;
  int rows_ = 0;
};

// Triangulation of a simple polygon by ear clipping in the xy plane; elevations are kept.

/// Triangles that fill the outline (either orientation); a remainder that is not simple is filled
/// as a fan.
std::vector<std::array<Eigen::Vector3d, 3>> triangulate(std::vector<Eigen::Vector3d> outline);

/// A flat piece of ground (map frame [m]).
struct Surface {
  std::array<Eigen::Vector3d, 4> corners;
  int count = 4;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< normal, not of unit length
  Color color = kAsphalt;
  double rank = rank::kRoad;  ///< larger wins where surfaces coincide (canvas.h)
  bool two_sided = false;     ///< drawn in the same color from below
  SceneClass kind = SceneClass::kRoad;
};

/// A painted line (map frame [m]).
struct Marking {
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  Eigen::Vector3d side = Eigen::Vector3d::Zero();  ///< half its width, pointing left
  Color color = kWhitePaint;
};

/// Asphalt of lanes and junctions, pavements, and the sides of roads above their surroundings.
std::vector<Surface> surfacesOf(const map::RoadNetwork& network);

/// The static ground of a network: asphalt of lanes and junctions, pavements, markings (map frame
/// [m]). Computed once from the network; FrontCamera draws what its view may see.
class RoadScene {
 public:
  explicit RoadScene(const map::RoadNetwork& network);
  /// Finds what the views may see; `draw` shows that in one of them.
  void look(const std::vector<View>& views);
  void draw(std::size_t index, const View& view, Canvas& canvas);

 private:
  void drawSurface(const Surface& surface, const View& view, Canvas& canvas) const;

  /// Sorts the visible markings, farthest first, because thin lines are drawn transparent.
  void sortMarkings(const View& view, std::vector<int>& markings);

  std::vector<Surface> surfaces_;
  std::vector<Marking> markings_;
  SpatialGrid surface_grid_;
  SpatialGrid marking_grid_;
  std::vector<std::vector<int>> visible_surfaces_;   ///< by view
  std::vector<std::vector<int>> visible_markings_;   ///< by view
  std::vector<std::pair<double, int>> by_distance_;  ///< buffer of sortMarkings
};

/// Draws a painted line unless it is seen from below.
void drawMarking(const Marking& marking, double rank, const View& view, Canvas& canvas);

/// A painted line between two points, `width` wide [m].
Marking markingBetween(const Eigen::Vector3d& begin, const Eigen::Vector3d& end, double width,
                       Color color);

}  // namespace cdiff::rendering
