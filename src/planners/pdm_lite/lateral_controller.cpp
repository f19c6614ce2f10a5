// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/lateral_controller.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {

double lookAheadDistance(double speed) {
  constexpr double kPointSpacing = 0.1;
  const double points = 0.9755321901954155 * 3.6 * speed + 1.9152884533402488;
  return kPointSpacing * std::floor(std::clamp(points, 24.0, 105.0));
}

LateralController::LateralController(const PdmLiteOptions& options)
    : pid_({options.resolved().lateral_kp, options.lateral.ki, options.lateral.kd},
           options.resolved().lateral_window) {}

double LateralController::steer(const geometry::Pose2d& pose, const Eigen::Vector2d& aim) {
  const Eigen::Vector2d offset = aim - pose.position;
  const double bearing = std::atan2(offset.y(), offset.x());
  const double error = core::angleDifference(bearing, pose.heading) / (0.5 * core::kPi);
  return std::clamp(std::round(pid_.update(error) * 1000.0) / 1000.0, -1.0, 1.0);
}

}  // namespace cdiff::planners
