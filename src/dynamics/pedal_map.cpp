// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/dynamics/pedal_map.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/text.h"

namespace cdiff::dynamics {
namespace {

constexpr double kLeastThrottle = 0.3;  // what the fit responds to
constexpr int kThrottleSteps = 70;      // of the throttle above it
constexpr int kThrottleHalvings = 40;   // of a step

/// The largest throttle of a step.
double throttleAt(int step) {
  return kLeastThrottle + (1.0 - kLeastThrottle) * step / kThrottleSteps;
}

/// Of two throttles, the first of which gives less than `acceleration`, the one between that gives
/// it.
double halved(const BicycleModel& model, double speed, double low, double high,
              double acceleration) {
  for (int i = 0; i < kThrottleHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (accelerationOf(model, speed, {middle, 0.0, 0.0}) < acceleration ? low : high) = middle;
  }
  return high;
}

/// Zero, or a throttle from 0.3 up: the smallest that reaches the acceleration, else the strongest.
double throttleFor(const BicycleModel& model, double speed, double acceleration) {
  const double least = accelerationOf(model, speed, {kLeastThrottle, 0.0, 0.0});
  if (acceleration <= 0.5 * least || acceleration == 0.0) return 0.0;
  double best = kLeastThrottle;
  double most = least;
  for (int step = 0; step <= kThrottleSteps; ++step) {
    const double reached = accelerationOf(model, speed, {throttleAt(step), 0.0, 0.0});
    if (reached >= acceleration) {
      if (step == 0) return kLeastThrottle;
      return halved(model, speed, throttleAt(step - 1), throttleAt(step), acceleration);
    }
    if (reached <= most) continue;
    most = reached;
    best = throttleAt(step);
  }
  return most > 0.0 ? best : 0.0;
}

}  // namespace

double accelerationOf(const BicycleModel& model, double speed,
                      const traffic::ControlAction& action) {
  return (model.nextSpeed(speed, action) - speed) / BicycleModel::kTick;
}

traffic::ControlAction pedalsFor(const BicycleModel& model, double speed, double acceleration) {
  if (!std::isfinite(speed) || speed < 0.0 || !std::isfinite(acceleration)) {
    throw std::invalid_argument("pedalsFor: speed " + core::formatNumber(speed) +
                                " m/s, acceleration " + core::formatNumber(acceleration) +
                                " m/s^2; expected finite numbers and no negative speed");
  }
  if (acceleration >= 0.0) return {throttleFor(model, speed, acceleration), 0.0, 0.0};
  const double full = accelerationOf(model, speed, traffic::ControlAction::failSafe());
  return {0.0, 0.0, full < 0.0 ? std::min(1.0, acceleration / full) : 1.0};
}

double largestCurvature(const BicycleModel& model) {
  return std::sin(model.slip(1.0)) / model.options().rear_length;
}

double steerFor(const BicycleModel& model, double curvature) {
  constexpr double kRounding = 1e-9;
  const double largest = largestCurvature(model);
  if (!(std::abs(curvature) <= largest + kRounding)) {
    throw std::invalid_argument("steerFor: curvature " + core::formatNumber(curvature) +
                                " 1/m; the vehicle's largest is " + core::formatNumber(largest) +
                                " 1/m");
  }
  const BicycleModelOptions& options = model.options();
  const double slip = std::asin(std::clamp(curvature, -largest, largest) * options.rear_length);
  const double wheel = std::atan(std::tan(slip) * (options.front_length + options.rear_length) /
                                 options.rear_length);
  return std::clamp(wheel / options.steering_gain, -1.0, 1.0);
}

}  // namespace cdiff::dynamics
