// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <vector>

#include "planners/uniad_mini/uniad_mini_weights.h"

namespace cdiff::planners {

/// Rows that a 3 x 3 convolution of a map reads, by cell and tap (row by row from the upper left
/// one); -1 beyond the map.
std::vector<std::int64_t> neighborCells(const inference::MapGrid& grid);

/// Features of each cell's neighborhood side by side, zeros beyond the map: a row of taps x
/// channels for a linear layer, which makes the two together a convolution. `channels`: a multiple
/// of 16.
void gatherNeighbors(const std::vector<std::int64_t>& neighbors, const inference::Rows& cells,
                     std::int64_t channels, inference::Rows& gathered);

/// to [rows x columns of `fine`] = mean of each 2 x 2 cells.
void halveMap(const inference::MapGrid& fine, const inference::Rows& from, std::int64_t channels,
              inference::Rows& to);

/// The cell of the halved map that covers a cell of the fine one.
inline std::int64_t halvedCell(const inference::MapGrid& fine, std::int64_t cell) {
  return cell / fine.width / 2 * (fine.width / 2) + cell % fine.width / 2;
}

}  // namespace cdiff::planners
