// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "rendering/view.h"

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

  /// Indices of the things that may be seen, cell by cell, in the order of the cells and indices.
  void visible(const View& view, std::vector<int>& found) const;

 private:
  void sortIntoCells();
  void boundCells();
  std::size_t cellOf(const Eigen::Vector3d& point) const;
  std::vector<Bound> bounds_;
  std::vector<int> items_;               ///< by cell
  std::vector<std::size_t> cell_begin_;  ///< of each cell in items_, and the end
  std::vector<Bound> cell_bounds_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int columns_ = 0;
  int rows_ = 0;
};

}  // namespace cdiff::rendering
