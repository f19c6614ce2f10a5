// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/comfort_measures.h"

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

void ComfortMeasures::observe(const std::vector<CbvSighting>& cbvs) {
  std::map<std::string, double> magnitudes;
  for (const CbvSighting& cbv : cbvs) {
    const traffic::Vehicle& vehicle = *cbv.vehicle;
    speeds_.add(vehicle.state.speed);
    const BodyAcceleration acceleration = bodyAcceleration(vehicle);
    const double magnitude = acceleration.magnitude();
    if (!std::isfinite(magnitude)) continue;
    accelerations_.add(magnitude);
    std::optional<double> jerk;
    const auto last = last_magnitudes_.find(vehicle.id);
    if (last != last_magnitudes_.end()) jerk = (magnitude - last->second) / decision_period_;
    if (jerk) jerks_.add(*jerk);
    uncomfortable_.add(isUncomfortable(acceleration, jerk));
    magnitudes[vehicle.id] = magnitude;
  }
  last_magnitudes_.swap(magnitudes);
}

DistributionMeasure ComfortMeasures::speed() const { return speeds_.measure("m/s", kNoCbv); }

DistributionMeasure ComfortMeasures::acceleration() const {
  return accelerations_.measure("m/s^2", kNoCbv);
}

DistributionMeasure ComfortMeasures::jerk() const {
  return jerks_.measure("m/s^3", accelerations_.count() == 0
                                     ? kNoCbv
                                     : "no CBV was driven for two decisions in a row");
}

Measure ComfortMeasures::uncomfortableRatePercent() const { return uncomfortable_.measure(kNoCbv); }

}  // namespace cdiff::metrics
