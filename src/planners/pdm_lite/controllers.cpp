// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/controllers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {

double lookAheadDistance(double speed) {
  constexpr double kPointSpacing = 0.1;
  const double points = 0.9755321901954155 * 3.6 * speed + 1.9152884533402488;
  return kPointSpacing * std::floor(std::clamp(points, 24.0, 105.0));
}

LateralController::LateralController(const PdmLiteOptions& options)
    : kp_(options.lateral_kp),
      ki_(options.lateral_ki),
      kd_(options.lateral_kd),
      errors_(static_cast<std::size_t>(options.lateral_window), 0.0) {}

double LateralController::steer(const geometry::Pose2d& pose, const Eigen::Vector2d& aim) {
  const Eigen::Vector2d offset = aim - pose.position;
  const double bearing = std::atan2(offset.y(), offset.x());
  const double error = core::angleDifference(bearing, pose.heading) / (0.5 * core::kPi);
  const double change = error - errors_.back();
  errors_.pop_front();
  errors_.push_back(error);
  const double sum = std::accumulate(errors_.begin(), errors_.end(), 0.0);
  const double mean = sum / static_cast<double>(errors_.size());
  const double output = kp_ * error + ki_ * mean + kd_ * change;
  return std::clamp(std::round(output * 1000.0) / 1000.0, -1.0, 1.0);
}

namespace {

constexpr double kKmhPerMps = 3.6;
constexpr double kFullThrottleError = 1.89;         // [km/h]
constexpr double kBrakeRatio = 1.031266635497984;   // speed / target above which it brakes
constexpr double kForecastNoThrottleError = -4.82;  // [km/h]

double regressionThrottle(double speed_kmh, double error_kmh) {
  const double c = speed_kmh / 100.0;
  const double e = std::max(error_kmh, 0.0) / 100.0;
  const double value = 1.1990342347353184 * c - 0.8057602384167799 * c * c +
                       1.710818710950062 * 100.0 * e + 0.921890257450335 * e * e +
                       1.556497522998393 * c * e - 0.7013479734904027 * c * c * e;
  return std::clamp(value, 0.0, 1.0);
}

}  // namespace

PedalCommand pedals(double speed, double target_speed) {
  if (target_speed < 1e-5) return {0.0, true};
  const double speed_kmh = kKmhPerMps * speed;
  const double target_kmh = std::max(1.0, kKmhPerMps * target_speed);
  const double error = target_kmh - speed_kmh;
  if (error > kFullThrottleError) return {1.0, false};
  if (speed_kmh / target_kmh > kBrakeRatio) return {0.0, true};
  return {regressionThrottle(speed_kmh, error), false};
}

double forecastThrottle(double speed, double target_speed) {
  const double error = kKmhPerMps * (target_speed - speed);
  if (error > kFullThrottleError) return 1.0;
  if (error < kForecastNoThrottleError) return 0.0;
  return regressionThrottle(kKmhPerMps * speed, error);
}

}  // namespace cdiff::planners
