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

namespace {

/// Right-hand side of the model.
class IdmEquation {
 public:
  IdmEquation(double desired_speed, double deceleration, const IdmObstacle& obstacle,
              double acceleration)
      : desired_speed_(desired_speed),
        obstacle_(obstacle),
        acceleration_(acceleration),
        closing_scale_(2.0 * std::sqrt(acceleration * deceleration)) {}

  /// dv/dt at a time, with `traveled` meters driven since the start and speed `v`.
  double acceleration(double time, double travelled, double v) const {
    const double wanted_gap = obstacle_.minimum_gap + v * obstacle_.time_headway +
                              v * (v - obstacle_.speed) / closing_scale_;
    const double gap =
        std::max(0.1, obstacle_.distance + time * obstacle_.speed - travelled - obstacle_.length);
    const double free = std::pow(v / desired_speed_, 4);
    return acceleration_ * (1.0 - free - (wanted_gap / gap) * (wanted_gap / gap));
  }

 private:
  double desired_speed_;
  IdmObstacle obstacle_;
  double acceleration_;
  double closing_scale_;
};

}  // namespace

double idmSpeed(double speed, double desired_speed, const IdmObstacle& obstacle,
                const IdmParameters& parameters) {
  if (!(desired_speed > 0.0)) return 0.0;
  constexpr int kSteps = 10;
  const double h = parameters.time_bound / kSteps;
  const double deceleration =
      speed <= parameters.slow_speed ? parameters.slow_deceleration : parameters.fast_deceleration;
  const IdmEquation idm(desired_speed, deceleration, obstacle, parameters.acceleration);
  double x = 0.0;
  double v = speed;
  for (int i = 0; i < kSteps; ++i) {
    const double t = i * h;
    const double a1 = idm.acceleration(t, x, v);
    const double v2 = v + 0.5 * h * a1;
    const double a2 = idm.acceleration(t + 0.5 * h, x + 0.5 * h * v, v2);
    const double v3 = v + 0.5 * h * a2;
    const double a3 = idm.acceleration(t + 0.5 * h, x + 0.5 * h * v2, v3);
    const double v4 = v + h * a3;
    const double a4 = idm.acceleration(t + h, x + h * v3, v4);
    x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return std::max(0.0, v);
}

}  // namespace cdiff::planners
