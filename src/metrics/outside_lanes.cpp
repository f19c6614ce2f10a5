// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/outside_lanes.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::metrics {

bool isOutsideLanes(const map::RoadNetwork& network, const traffic::VehicleState& ego,
                    const InfractionOptions& options) {
  constexpr double kWidestHalf = 10.0;  // [m] no lane is broader to a side
  if (!ego.position.allFinite()) return false;
  const double radius = kWidestHalf + options.outside_lane_margin;
  const auto near = network.lanesNear(ego.position, ego.elevation, radius, ego.heading);
  const auto holds = [&](const map::LaneMatch& match) {
    const double half = 0.5 * network.lane(match.lane).width;
    return match.projection.distance <= half + options.outside_lane_margin;
  };
  if (std::none_of(near.begin(), near.end(), holds)) return true;
  if (network.lane(near.front().lane).internal) return false;
  const double angle = std::abs(near.front().heading_difference);
  return angle > core::degreesToRadians(options.wrong_lane_angle);
}

void OutsideLanes::observe(const traffic::VehicleState& ego, double advance) {
  ++ticks_;
  if (advance <= 0.0) return;
  advance_ += advance;
  if (isOutsideLanes(network_, ego, options_)) outside_ += advance;
}

}  // namespace cdiff::metrics
