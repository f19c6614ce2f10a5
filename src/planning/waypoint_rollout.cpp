// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/waypoint_rollout.h"

#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planning {

std::vector<RolloutPoint> rolloutAlong(const traffic::VehicleState& start,
                                       const std::vector<Eigen::Vector2d>& waypoints, double period,
                                       const traffic::ControlAction& action) {
  constexpr double kStandstill = 0.05;  // shorter lines have no direction [m]
  const auto steps = static_cast<int>(std::lround(period / traffic::kRolloutStep));
  std::vector<RolloutPoint> rollout;
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  double heading = start.heading;
  for (const Eigen::Vector2d& waypoint : waypoints) {
    const Eigen::Vector2d line = waypoint - last;
    if (line.norm() > kStandstill)
      heading = core::wrapAngle(start.heading + std::atan2(line.y(), line.x()));
    for (int step = 1; step <= steps; ++step) {
      traffic::VehicleState state = start;
      state.position = start.pose().toMap(last + line * step / steps);
      state.heading = heading;
      state.speed = line.norm() / period;
      rollout.push_back({state, action});
    }
    last = waypoint;
  }
  return rollout;
}

}  // namespace cdiff::planning
