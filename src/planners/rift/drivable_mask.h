// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "e2e_cdiff/map/drivable_area.h"

namespace cdiff::planners {

/// Which cells of 0.5 m have their center on the drivable area, in tiles of 16 m that are made when
/// they are first asked for and kept (map frame).
class DrivableMask {
 public:
  static constexpr double kCell = 0.5;   ///< [m]
  static constexpr int kTileCells = 32;  ///< along an edge of a tile
  using Tile = std::bitset<kTileCells * kTileCells>;

  /// `area` must outlive the mask.
  explicit DrivableMask(const map::DrivableArea& area) : area_(&area) {}
  /// The tile of these numbers (its cells begin at number x 16 m) on a level. The reference stays.
  const Tile& tile(int x, int y, int level);
  /// The level of an elevation [m]: they are 2 m apart.
  static int levelOf(double elevation);

 private:
  const map::DrivableArea* area_;
  std::map<std::tuple<int, int, int>, std::unique_ptr<Tile>> tiles_;
};

/// The mask around a place, for many questions there.
class MaskWindow {
 public:
  MaskWindow(DrivableMask& mask, const Eigen::Vector2d& center);
  /// Goes to the level of an elevation [m]; it begins on that of 0.
  void moveTo(double elevation);
  /// Whether the cell of a place relative to the center [m] is drivable; false beyond 100 m.
  bool drivable(double x, double y);

 private:
  static constexpr int kReach = 6;  // tiles to each side, beyond that of the center
  static constexpr int kWide = 2 * kReach + 1;
  using Tiles = std::array<const DrivableMask::Tile*, kWide * kWide>;

  DrivableMask& mask_;
  int level_ = 0;
  int first_x_;  ///< number of the first tile
  int first_y_;
  double offset_x_;  ///< from the first tile's corner to the center [m]
  double offset_y_;
  std::map<int, Tiles> known_;  ///< by level; those that were asked for
  Tiles* tiles_;                ///< of the current level
};

}  // namespace cdiff::planners
