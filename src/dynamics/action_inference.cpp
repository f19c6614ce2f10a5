// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "dynamics/action_inference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "e2e_cdiff/traffic/rollout.h"

namespace cdiff::dynamics {
namespace {

constexpr int kSteps = 50;         // of a pedal
constexpr double kStanding = 0.5;  // [m/s]

/// `speed`: mean of those at which the two ticks begin.
double inferSteer(const BicycleModelOptions& options, double turn, double speed) {
  if (speed < kStanding) return 0.0;
  const double sine = turn * options.rear_length / (traffic::kRolloutStep * speed);
  const double slip = std::asin(std::clamp(sine, -0.9, 0.9));
  const double wheel = std::atan(std::tan(slip) * (options.front_length + options.rear_length) /
                                 options.rear_length);
  return std::clamp(wheel / options.steering_gain, -1.0, 1.0);
}

}  // namespace

traffic::ControlAction inferAction(const BicycleModel& model, const ObservedMotion& motion) {
  traffic::ControlAction best;
  double nearest = std::numeric_limits<double>::infinity();
  // From no pedal outwards, so that of equal ones the gentlest wins.
  for (int i = 0; i <= kSteps; ++i) {
    const double pedal = static_cast<double>(i) / kSteps;
    for (const traffic::ControlAction& action :
         {traffic::ControlAction{pedal, 0.0, 0.0}, traffic::ControlAction{0.0, 0.0, pedal}}) {
      const double next = model.nextSpeed(model.nextSpeed(motion.speed, action), action);
      const double error = std::abs(next - motion.next_speed);
      if (error >= nearest) continue;
      nearest = error;
      best = action;
    }
  }
  const double speed = 0.5 * (motion.speed + model.nextSpeed(motion.speed, best));
  best.steer = inferSteer(model.options(), motion.turn, speed);
  return best;
}

}  // namespace cdiff::dynamics
