// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cbv/interaction_score.h"

#include <algorithm>
#include <cmath>

namespace cdiff::cbv {

double arrivalTime(double distance, double speed, double minimum_speed) {
  return distance / std::max(speed, minimum_speed);
}

double interactionScore(const ConflictPoint& point, double separation, const CbvOptions& options) {
  const double distance_ratio = (point.cbv_distance - point.ego_distance) / options.distance_sigma;
  const double time_ratio = point.arrivalTimeGap() / options.time_sigma;
  return std::exp(-0.5 * distance_ratio * distance_ratio - 0.5 * time_ratio * time_ratio -
                  separation / options.nearness_length);
}

}  // namespace cdiff::cbv
