// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/body_motion.h"

#include <cmath>

namespace cdiff::metrics {

double BodyAcceleration::magnitude() const { return std::hypot(longitudinal, lateral); }

BodyAcceleration bodyAcceleration(const traffic::Vehicle& vehicle) {
  return {vehicle.acceleration, vehicle.state.speed * vehicle.yaw_rate};
}

bool isUncomfortable(const BodyAcceleration& acceleration, const std::optional<double>& jerk) {
  constexpr double kLeastLongitudinal = -4.05;  // [m/s^2]
  constexpr double kMostLongitudinal = 2.40;    // [m/s^2]
  constexpr double kMostLateral = 4.89;         // [m/s^2]
  constexpr double kMostJerk = 8.37;            // [m/s^3]
  const bool comfortable = acceleration.longitudinal > kLeastLongitudinal &&
                           acceleration.longitudinal < kMostLongitudinal &&
                           std::abs(acceleration.lateral) < kMostLateral &&
                           (!jerk || std::abs(*jerk) < kMostJerk);
  return !comfortable;
}

std::vector<BodyMotion> BodyMotions::observe(const std::vector<CbvSighting>& cbvs) {
  std::vector<BodyMotion> motions;
  std::map<std::string, double> magnitudes;
  for (const CbvSighting& cbv : cbvs) {
    const traffic::Vehicle& vehicle = *cbv.vehicle;
    BodyMotion motion{bodyAcceleration(vehicle), std::nullopt};
    const double magnitude = motion.acceleration.magnitude();
    if (!std::isfinite(magnitude)) continue;
    const auto last = last_magnitudes_.find(vehicle.id);
    if (last != last_magnitudes_.end()) motion.jerk = (magnitude - last->second) / decision_period_;
    magnitudes[vehicle.id] = magnitude;
    motions.push_back(motion);
  }
  last_magnitudes_.swap(magnitudes);
  return motions;
}

}  // namespace cdiff::metrics
