// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/spatial_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cdiff::rendering {
namespace {

constexpr double kCellSize = 25.0;  // [m]

int cellIndex(double offset, int count) {
  return offset > 0.0 ? static_cast<int>(std::min(offset, count - 1.0)) : 0;
}

}  // namespace

Bound boundOf(const Eigen::Vector3d* points, int count) {
  Eigen::Vector3d low = points[0];
  Eigen::Vector3d high = points[0];
  for (int i = 1; i < count; ++i) {
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
  }
  return {0.5 * (low + high), 0.5 * (high - low).norm()};
}

SpatialGrid::SpatialGrid(std::vector<Bound> bounds) : bounds_(std::move(bounds)) {
  if (bounds_.empty()) return;
  origin_ = bounds_.front().center.head<2>();
  Eigen::Vector2d end = origin_;
  for (const Bound& bound : bounds_) {
    origin_ = origin_.cwiseMin(bound.center.head<2>());
    end = end.cwiseMax(bound.center.head<2>());
  }
  columns_ = static_cast<int>((end.x() - origin_.x()) / kCellSize) + 1;
  rows_ = static_cast<int>((end.y() - origin_.y()) / kCellSize) + 1;
  sortIntoCells();
  boundCells();
}

void SpatialGrid::sortIntoCells() {
  items_.resize(bounds_.size());
  std::iota(items_.begin(), items_.end(), 0);
  const auto cell_of = [&](int item) {
    return cellOf(bounds_[static_cast<std::size_t>(item)].center);
  };
  std::stable_sort(items_.begin(), items_.end(),
                   [&](int left, int right) { return cell_of(left) < cell_of(right); });
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  cell_begin_.assign(cells + 1, 0);
  for (const int item : items_) ++cell_begin_[cell_of(item) + 1];
  std::partial_sum(cell_begin_.begin(), cell_begin_.end(), cell_begin_.begin());
}

void SpatialGrid::boundCells() {
  for (std::size_t cell = 0; cell + 1 < cell_begin_.size(); ++cell) {
    std::vector<Eigen::Vector3d> corners;
    for (std::size_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
      const Bound& bound = bounds_[static_cast<std::size_t>(items_[i])];
      corners.push_back(bound.center.array() - bound.radius);
      corners.push_back(bound.center.array() + bound.radius);
    }
    cell_bounds_.push_back(
        corners.empty() ? Bound{} : boundOf(corners.data(), static_cast<int>(corners.size())));
  }
}

std::size_t SpatialGrid::cellOf(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d offset = (point.head<2>() - origin_) / kCellSize;
  return static_cast<std::size_t>(offset.y()) * static_cast<std::size_t>(columns_) +
         static_cast<std::size_t>(offset.x());
}

void SpatialGrid::visible(const View& view, std::vector<int>& found) const {
  found.clear();
  if (bounds_.empty()) return;
  // Things and cells reach less than two cells beyond the cell of their center.
  const Eigen::Vector2d offset = (view.eye().head<2>() - origin_) / kCellSize;
  const double reach = view.farDistance() / kCellSize + 2.0;
  const int first_column = cellIndex(offset.x() - reach, columns_);
  const int last_column = cellIndex(offset.x() + reach, columns_);
  const int first_row = cellIndex(offset.y() - reach, rows_);
  const int last_row = cellIndex(offset.y() + reach, rows_);
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                               static_cast<std::size_t>(column);
      if (cell_begin_[cell] == cell_begin_[cell + 1]) continue;
      if (!view.maySee(cell_bounds_[cell].center, cell_bounds_[cell].radius)) continue;
      for (std::size_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
        const Bound& bound = bounds_[static_cast<std::size_t>(items_[i])];
        if (view.maySee(bound.center, bound.radius)) found.push_back(items_[i]);
      }
    }
  }
}

}  // namespace cdiff::rendering
