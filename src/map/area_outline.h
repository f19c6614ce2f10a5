// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Union of lane strips and polygons in the map frame [m], on a millimetre grid, with narrow slits
/// closed.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace cdiff::map {

/// Closed ring of points; the last is joined to the first.
using Ring = std::vector<Eigen::Vector2d>;

/// A band of constant width around a line, cut off square at its ends.
struct Strip {
  std::vector<Eigen::Vector2d> line;  ///< centre line, map frame [m]
  double width = 0.0;                 ///< [m]
};

/// Rings of the union with the area on their left: outer rings counter-clockwise, holes clockwise.
/// Slits narrower than 0.3 m (between abutting lanes, edges and junctions) are closed and holes
/// below 1 m^2 filled, so that they make no border.
std::vector<Ring> uniteOutlines(const std::vector<Strip>& strips,
                                const std::vector<Ring>& polygons);

}  // namespace cdiff::map
