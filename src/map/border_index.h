// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "e2e_cdiff/map/drivable_area.h"

namespace cdiff::map {

// Union of lane strips and polygons in the map frame [m], on a millimeter grid, with narrow slits
// closed.

/// Closed ring of points; the last is joined to the first.
using Ring = std::vector<Eigen::Vector2d>;

/// A band of constant width around a line, cut off square at its ends.
struct Strip {
  std::vector<Eigen::Vector2d> line;  ///< centerline, map frame [m]
  double width = 0.0;                 ///< [m]
};

/// Rings of the union with the area on their left: outer rings counter-clockwise, holes clockwise.
/// Slits narrower than 0.3 m (between abutting lanes, edges and junctions) are closed and holes
/// below 1 m^2 filled, so that they make no border.
std::vector<Ring> uniteOutlines(const std::vector<Strip>& strips,
                                const std::vector<Ring>& polygons);

/// Exact signed distance [m] from a point of the map frame to border rings: a quadtree whose leaves
/// list every border segment that can be nearest to any of their points.
/// Immutable after construction, so queries may run in parallel.
class BorderIndex {
 public:
  /// Rings with the area on their left. Throws InputError without any.
  explicit BorderIndex(const std::vector<Ring>& rings);

  /// Positive on the area. On the border the gradient is the normal toward the area.
  SignedDistance query(const Eigen::Vector2d& point) const;

 private:
  using SegmentIndex = std::uint32_t;
  /// From `begin` to `end`, the area on the left.
  struct Segment {
    Eigen::Vector2d begin;
    Eigen::Vector2d end;
    Eigen::Vector2d along;  ///< unit vector
    double length;
  };
  /// Square cell; `first_child` = 0 marks a leaf, whose segments are candidates_[begin, end).
  struct Node {
    std::uint32_t first_child = 0;
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };
  struct Square {
    Eigen::Vector2d center;
    double half = 0.0;
    Square child(int quadrant) const;
  };
  struct Nearest;

  void addSegments(const Ring& ring);
  void build(std::uint32_t node, const Square& square,
             const std::vector<SegmentIndex>& from_parent);
  void examine(const Segment& segment, const Eigen::Vector2d& point, Nearest& nearest) const;
  static double distance(const Segment& segment, const Eigen::Vector2d& point);
  Nearest nearest(const Eigen::Vector2d& point) const;

  std::vector<Segment> segments_;
  std::vector<Node> nodes_;
  std::vector<SegmentIndex> candidates_;
  Square root_;
};

}  // namespace cdiff::map
