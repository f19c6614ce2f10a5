// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
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

/// Points of a union lie on a grid of this many units a meter.
inline constexpr double kUnitsPerMeter = 1000.0;

/// Rings of the union with the area on their left: outer rings counter-clockwise, holes clockwise.
/// Slits narrower than 0.3 m (between abutting lanes, edges and junctions) are closed and holes
/// below 1 m^2 filled, so that they make no border.
std::vector<Ring> uniteOutlines(const std::vector<Strip>& strips,
                                const std::vector<Ring>& polygons);

/// Exact signed distance [m] from a point of the map frame to border rings: a quadtree whose leaves
/// list every border segment that can be nearest to any of their points. Squares of 64 m are split
/// when a query first comes to them: a session seldom comes to all of a town. Queries may run in
/// parallel.
class BorderIndex {
 public:
  /// Rings with the area on their left. Throws InputError without any.
  explicit BorderIndex(const std::vector<Ring>& rings);
  ~BorderIndex();
  BorderIndex(const BorderIndex&) = delete;
  BorderIndex& operator=(const BorderIndex&) = delete;

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
  struct Square {
    Eigen::Vector2d center;
    double half = 0.0;
    Square child(int quadrant) const;
  };
  struct Tree;
  struct Tile;
  struct Nearest;

  void addSegments(const Ring& ring);
  /// The segments of `from_parent` that can be nearest to a point of the square, and whether the
  /// square is worth splitting.
  bool keepNear(const Square& square, const std::vector<SegmentIndex>& from_parent,
                std::vector<SegmentIndex>& kept) const;
  /// Splits squares above `largest_tile` [m] and makes tiles of the others; 0 splits all.
  void build(Tree& tree, std::uint32_t node, const Square& square,
             const std::vector<SegmentIndex>& from_parent, double largest_tile) const;
  /// Of a tile, which is split if it is not yet.
  const Tree& treeOf(Tile& tile) const;
  void examine(const Segment& segment, const Eigen::Vector2d& point, Nearest& nearest) const;
  static double distance(const Segment& segment, const Eigen::Vector2d& point);
  Nearest nearest(const Eigen::Vector2d& point) const;

  std::vector<Segment> segments_;
  Square root_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace cdiff::map
