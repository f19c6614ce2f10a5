// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/drivable_mask.h"

#include <cmath>

namespace cdiff::planners {
namespace {

constexpr double kTileLength = DrivableMask::kCell * DrivableMask::kTileCells;  // [m]
constexpr double kLevelStep = 2.0;                                              // [m]

int tileOf(double coordinate) { return static_cast<int>(std::floor(coordinate / kTileLength)); }

}  // namespace

int DrivableMask::levelOf(double elevation) {
  return static_cast<int>(std::lround(elevation / kLevelStep));
}

const DrivableMask::Tile& DrivableMask::tile(int x, int y, int level) {
  std::unique_ptr<Tile>& tile = tiles_[{x, y, level}];
  if (tile) return *tile;
  tile = std::make_unique<Tile>();
  const Eigen::Vector2d corner(x * kTileLength, y * kTileLength);
  for (int row = 0; row < kTileCells; ++row) {
    for (int column = 0; column < kTileCells; ++column) {
      const Eigen::Vector2d center = corner + kCell * Eigen::Vector2d(column + 0.5, row + 0.5);
      if (area_->contains(center, level * kLevelStep))
        tile->set(static_cast<std::size_t>(row * kTileCells + column));
    }
  }
  return *tile;
}

MaskWindow::MaskWindow(DrivableMask& mask, const Eigen::Vector2d& center)
    : mask_(mask),
      first_x_(tileOf(center.x()) - kReach),
      first_y_(tileOf(center.y()) - kReach),
      offset_x_(center.x() - first_x_ * kTileLength),
      offset_y_(center.y() - first_y_ * kTileLength),
      tiles_(&known_[level_]) {}

void MaskWindow::moveTo(double elevation) {
  const int level = DrivableMask::levelOf(elevation);
  if (level == level_) return;
  level_ = level;
  tiles_ = &known_[level];
}

bool MaskWindow::drivable(double x, double y) {
  constexpr double kCells = kWide * DrivableMask::kTileCells;
  const double column = (x + offset_x_) / DrivableMask::kCell;
  const double row = (y + offset_y_) / DrivableMask::kCell;
  if (!(column >= 0.0 && column < kCells && row >= 0.0 && row < kCells)) return false;
  const auto c = static_cast<unsigned>(column);
  const auto r = static_cast<unsigned>(row);
  constexpr unsigned kTile = DrivableMask::kTileCells;
  const unsigned tile_x = c / kTile;
  const unsigned tile_y = r / kTile;
  const DrivableMask::Tile*& tile = (*tiles_)[tile_y * kWide + tile_x];
  if (tile == nullptr) {
    tile = &mask_.tile(first_x_ + static_cast<int>(tile_x), first_y_ + static_cast<int>(tile_y),
                       level_);
  }
  return (*tile)[(r % kTile) * kTile + c % kTile];
}

}  // namespace cdiff::planners
