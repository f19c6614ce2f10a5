// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/neighbor_cells.h"

#include <algorithm>

namespace cdiff::planners {

std::vector<std::int64_t> neighborCells(const inference::MapGrid& grid) {
  std::vector<std::int64_t> neighbors;
  for (std::int64_t cell = 0; cell < grid.cells(); ++cell) {
    for (std::int64_t tap = 0; tap < kTaps; ++tap) {
      const std::int64_t row = cell / grid.width + tap / 3 - 1;
      const std::int64_t column = cell % grid.width + tap % 3 - 1;
      const bool inside = row >= 0 && row < grid.height && column >= 0 && column < grid.width;
      neighbors.push_back(inside ? row * grid.width + column : -1);
    }
  }
  return neighbors;
}

void gatherNeighbors(const std::vector<std::int64_t>& neighbors, const inference::Rows& cells,
                     std::int64_t channels, inference::Rows& gathered) {
  gathered.resize(cells.rows(), kTaps * channels);
  for (std::size_t i = 0; i < neighbors.size(); ++i) {
    const auto index = static_cast<std::int64_t>(i);
    float* to = gathered.row(index / kTaps) + index % kTaps * channels;
    if (neighbors[i] < 0) {
      std::fill_n(to, channels, 0.0F);
    } else {
      std::copy_n(cells.row(neighbors[i]), channels, to);
    }
  }
}

void halveMap(const inference::MapGrid& fine, const inference::Rows& from, std::int64_t channels,
              inference::Rows& to) {
  to.resize(fine.cells() / 4, channels);
  for (std::int64_t row = 0; row < to.rows(); ++row) std::fill_n(to.row(row), channels, 0.0F);
  for (std::int64_t cell = 0; cell < fine.cells(); ++cell) {
    float* sum = to.row(halvedCell(fine, cell));
    for (std::int64_t c = 0; c < channels; ++c) sum[c] += 0.25F * from.row(cell)[c];
  }
}

}  // namespace cdiff::planners
