// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/planning/planner.h"

namespace cdiff::planning {

// What is shown of a perception.

/// The forecast of the largest probability, the first of equals; there must be one.
const PerceivedForecast& likeliest(const std::vector<PerceivedForecast>& forecasts);

/// Centers of the cells that are occupied with a probability above 0.5, in `occupancy.frame` [m].
std::vector<Eigen::Vector2d> occupiedCells(const PerceivedOccupancy& occupancy);

}  // namespace cdiff::planning
