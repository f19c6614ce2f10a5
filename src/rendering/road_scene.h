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

/// A ball that holds a thing.
struct Bound {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// The ball around the middle of the points' box.
Bound boundOf(const Eigen::Vector3d* points, int count);

/// Finds things near the view: things sorted into square cells by their center.
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
  std::vector<int> items_;               ///< by cell
  std::vector<std::size_t> cell_begin_;  ///< of each cell in items_, and the end
  std::vector<Bound> cell_bounds_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int columns_ = 0;
  int rows_ = 0;
};

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
  SceneClass kind = SceneClass::kRoad;
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
  /// Finds what the views may see; `draw` shows that in one of them.
  void look(const std::vector<View>& views);
  void draw(std::size_t index, const View& view, Canvas& canvas);

 private:
  void drawSurface(const Surface& surface, const View& view, Canvas& canvas) const;

  /// Farthest first: thin lines are transparent.
  void sortMarkings(const View& view, std::vector<int>& markings);

  std::vector<Surface> surfaces_;
  std::vector<Marking> markings_;
  SpatialGrid surface_grid_;
  SpatialGrid marking_grid_;
  std::vector<std::vector<int>> visible_surfaces_;   ///< by view
  std::vector<std::vector<int>> visible_markings_;   ///< by view
  std::vector<std::pair<double, int>> by_distance_;  ///< buffer of sortMarkings
};

/// Draws a painted line if it is seen from above.
void drawMarking(const Marking& marking, double rank, const View& view, Canvas& canvas);

/// A painted line between two points, `width` wide [m].
Marking markingBetween(const Eigen::Vector3d& begin, const Eigen::Vector3d& end, double width,
                       Color color);

// Borders of a lane: points beside its centerline that fit together at bends.

/// A cross-section of a lane.
struct CrossSection {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector2d left = Eigen::Vector2d::Zero();  ///< where 1 m to the left lies, at bends longer
  double arc_length = 0.0;                         ///< [m]

  /// The point `lateral` meters to the left.
  Eigen::Vector3d at(double lateral) const {
    return {center.x() + lateral * left.x(), center.y() + lateral * left.y(), center.z()};
  }
};

/// Cross-sections from arc length `begin` to `end`: both, every point of the line between them, and
/// more so that neighbors are at most `spacing` apart.
std::vector<CrossSection> crossSections(const geometry::Polyline& line, double begin, double end,
                                        double spacing);

// The markings of a network's lanes: solid white lines at the road's edges, dashed white ones
// between lanes of one direction, solid yellow ones beside lanes of the other direction.

/// What a piece of a lane's outer border is: the road's edge, the centerline to the lanes of the
/// other direction, or nothing (it lies on another lane).
enum class Border { kEdge, kCenter, kNone };

/// `point` lies on the border, `heading` is the lane's there.
Border borderAt(const map::RoadNetwork& network, const map::Lane& lane,
                const Eigen::Vector3d& point, double heading);

std::vector<Marking> laneMarkings(const map::RoadNetwork& network);

/// What stands beside roads that lie higher than their surroundings: grass slopes down to the
/// lowest road near, or the side of a bridge's deck where a lower road is in the way.
std::vector<Surface> roadSides(const map::RoadNetwork& network);

}  // namespace cdiff::rendering
