// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/waypoint_controller.h"

#include <cmath>

namespace cdiff::planners {

using planning::turnErrorToward;

WaypointControllerOptions::WaypointControllerOptions() {
  pids.turn = {2.25, 0.0, 0.3};
  pids.speed = {5.0, 0.5, 1.0};
  pids.window = 40;
  pids.speed_error_limit = 0.25;
  pids.max_throttle = 0.75;
}

void WaypointControllerOptions::describe(core::OptionsVisitor& visitor) {
  pids.describe(visitor);
  visitor.number({"aim_distance", "m", "Distance of the waypoint that is steered at."},
                 aim_distance, 0.5, 50.0);
  visitor.number({"target_angle", "90 deg",
                  "Difference of the target point from the last segment above which it is aimed "
                  "at."},
                 target_angle, 0.0, 4.0);
  visitor.number({"target_distance", "m", "Only where the target point is nearer."},
                 target_distance, 0.0, 100.0);
}

double desiredSpeed(const EgoWaypoints& waypoints) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < waypoints.size(); ++i)
    sum += (waypoints[i + 1] - waypoints[i]).norm();
  return sum / (kEgoWaypointPeriod * static_cast<double>(waypoints.size() - 1));
}

WaypointController::WaypointController(const WaypointControllerOptions& options)
    : options_(options), pids_(options.pids) {}

double WaypointController::turnError(const EgoWaypoints& waypoints,
                                     const Eigen::Vector2d& target) const {
  Eigen::Vector2d aim = waypoints.front();
  double nearest = 1e5;
  for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
    const double distance = (0.5 * (waypoints[i] + waypoints[i + 1])).norm();
    if (std::abs(options_.aim_distance - distance) >= std::abs(options_.aim_distance - nearest))
      continue;
    aim = waypoints[i];
    nearest = distance;
  }
  const double angle = turnErrorToward(aim);
  const double last = turnErrorToward(waypoints.back() - waypoints[waypoints.size() - 2]);
  const double to_target = turnErrorToward(target);
  const bool outlier =
      std::abs(to_target - last) > options_.target_angle && target.x() < options_.target_distance;
  return std::abs(to_target) < std::abs(angle) || outlier ? to_target : angle;
}

traffic::ControlAction WaypointController::track(double speed, const EgoWaypoints& waypoints,
                                                 const Eigen::Vector2d& target) {
  return pids_.track(speed, desiredSpeed(waypoints), turnError(waypoints, target));
}

}  // namespace cdiff::planners
