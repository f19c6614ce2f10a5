// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/forecasts.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "planning/surrounding_vehicles.h"

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
  double acceleration(double time, double traveled, double v) const {
    const double wanted_gap = obstacle_.minimum_gap + v * obstacle_.time_headway +
                              v * (v - obstacle_.speed) / closing_scale_;
    const double gap =
        std::max(0.1, obstacle_.distance + time * obstacle_.speed - traveled - obstacle_.length);
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

namespace {

constexpr double kEgoFast = 5.0;  // [m/s]
constexpr double kEgoLengthFactor = 1.3;
constexpr double kEgoWidthFactor = 1.2;
constexpr double kOtherSlow = 1.0;  // [m/s]
constexpr double kOtherLengthFactor = 1.2;
constexpr double kOtherLengthFactorLaneChange = 2.0;
constexpr double kOtherWidthFactor = 1.3;

geometry::OrientedBox grown(const traffic::VehicleState& state,
                            const traffic::VehicleDimensions& dimensions, double length_factor,
                            double width_factor) {
  return {state.position, state.heading, length_factor * dimensions.length,
          width_factor * dimensions.width};
}

/// Cheap test that spares the separating axes: circles around both boxes.
bool mayOverlap(const geometry::OrientedBox& first, const geometry::OrientedBox& second) {
  const double reach = 0.5 * (first.length + first.width + second.length + second.width);
  return (first.center - second.center).squaredNorm() <= reach * reach;
}

}  // namespace

std::vector<geometry::OrientedBox> egoBoxes(const traffic::Vehicle& ego,
                                            const std::vector<planning::RolloutPoint>& forecast) {
  const bool fast = ego.state.speed >= kEgoFast;
  std::vector<geometry::OrientedBox> boxes;
  boxes.reserve(forecast.size());
  for (const planning::RolloutPoint& point : forecast) {
    boxes.push_back(grown(point.state, ego.dimensions, fast ? kEgoLengthFactor : 1.0,
                          fast ? kEgoWidthFactor : 1.0));
  }
  return boxes;
}

std::vector<geometry::OrientedBox> otherBoxes(const traffic::VehicleDimensions& dimensions,
                                              const std::vector<traffic::VehicleState>& forecast,
                                              std::size_t steps, bool near_lane_change) {
  const double length_factor = near_lane_change ? kOtherLengthFactorLaneChange : kOtherLengthFactor;
  const std::size_t count = std::min(steps, forecast.size());
  std::vector<geometry::OrientedBox> boxes;
  boxes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool slow = forecast[i].speed < kOtherSlow;
    const double share = static_cast<double>(i) / static_cast<double>(count);
    const double width_factor = std::max(1.0, kOtherWidthFactor * share);
    boxes.push_back(
        grown(forecast[i], dimensions, slow ? 1.0 : length_factor, slow ? 1.0 : width_factor));
  }
  return boxes;
}

std::optional<std::size_t> meet(const std::vector<geometry::OrientedBox>& first,
                                const std::vector<geometry::OrientedBox>& second,
                                std::size_t steps) {
  const std::size_t count = std::min({steps, first.size(), second.size()});
  for (std::size_t i = 0; i < count; ++i) {
    if (mayOverlap(first[i], second[i]) && geometry::overlap(first[i], second[i])) return i;
  }
  return std::nullopt;
}

double steerAlong(const map::Route& route, const traffic::VehicleState& state,
                  DriverState& driver) {
  driver.follower.update(route, state.position);
  const double aim = driver.follower.arcLength() + lookAheadDistance(state.speed);
  return driver.lateral.steer(state.pose(), route.path().extendedPoseAt(aim).position);
}

std::vector<planning::RolloutPoint> forecastEgo(const traffic::VehicleState& start,
                                                const map::Route& route, DriverState driver,
                                                double target_speed,
                                                const dynamics::BicycleModel& model,
                                                const EgoHorizon& horizon) {
  std::vector<planning::RolloutPoint> points;
  points.reserve(horizon.steps);
  traffic::VehicleState state = start;
  for (std::size_t i = 0; i < horizon.steps; ++i) {
    traffic::ControlAction action;
    for (int decision = 0; decision < horizon.decisions; ++decision) {
      action.steer = steerAlong(route, state, driver);
      action.throttle = forecastThrottle(state.speed, target_speed);
      state = model.step(state, action, planning::kForecastStep / horizon.decisions);
    }
    points.push_back({state, action});
  }
  return points;
}

}  // namespace cdiff::planners
