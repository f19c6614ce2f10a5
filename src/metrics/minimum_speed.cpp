// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/minimum_speed.h"

#include <algorithm>
#include <cmath>

namespace cdiff::metrics {
namespace {

/// Mean speed of the background vehicles; NaN without any.
double backgroundSpeed(const traffic::TrafficSnapshot& snapshot) {
  double sum = 0.0;
  std::size_t n = 0;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role != traffic::VehicleRole::kBackground) continue;
    if (!std::isfinite(vehicle.state.speed)) continue;
    sum += vehicle.state.speed;
    ++n;
  }
  return sum / static_cast<double>(n);
}

}  // namespace

MinimumSpeed::MinimumSpeed(double length, std::size_t checkpoints)
    : length_(length), checkpoints_(checkpoints) {}

void MinimumSpeed::observe(double arc_length, double ego_speed,
                           const traffic::TrafficSnapshot& snapshot) {
  if (passed_ == checkpoints_) return;
  arc_length_ = arc_length;
  const double background = backgroundSpeed(snapshot);
  if (std::isfinite(background) && std::isfinite(ego_speed)) {
    open_.ego += ego_speed;
    open_.background += background;
  }
  const double stretch = length_ / static_cast<double>(checkpoints_);
  const auto reached = static_cast<std::size_t>(std::floor(arc_length / stretch));
  if (reached <= passed_) return;
  passed_ = std::min(reached, checkpoints_);
  if (open_.background > 0.0) percents_.push_back(100.0 * open_.ego / open_.background);
  open_ = {};
}

std::vector<double> MinimumSpeed::percents() const {
  constexpr double kRouteEnd = 0.95;  // share of the route; its last metres are not always driven
  std::vector<double> percents = percents_;
  const bool ended = passed_ < checkpoints_ && arc_length_ > kRouteEnd * length_;
  if (ended && open_.background > 0.0) percents.push_back(100.0 * open_.ego / open_.background);
  return percents;
}

}  // namespace cdiff::metrics
