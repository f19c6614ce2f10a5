// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/idm.h"

#include <algorithm>
#include <cmath>

namespace cdiff::planners {
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

}  // namespace cdiff::planners
