// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/perception.h"

#include <algorithm>

namespace cdiff::planning {

const PerceivedForecast& likeliest(const std::vector<PerceivedForecast>& forecasts) {
  return *std::max_element(forecasts.begin(), forecasts.end(),
                           [](const PerceivedForecast& left, const PerceivedForecast& right) {
                             return left.probability < right.probability;
                           });
}

std::vector<Eigen::Vector2d> occupiedCells(const PerceivedOccupancy& occupancy) {
  constexpr float kOccupied = 0.5F;
  std::vector<Eigen::Vector2d> centers;
  for (int row = 0; row < occupancy.rows; ++row) {
    for (int column = 0; column < occupancy.columns; ++column) {
      const auto index = static_cast<std::size_t>(row * occupancy.columns + column);
      if (occupancy.probability.at(index) > kOccupied)
        centers.push_back(occupancy.origin +
                          occupancy.cell * Eigen::Vector2d(row + 0.5, column + 0.5));
    }
  }
  return centers;
}

}  // namespace cdiff::planning
