// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/longitudinal_controller.h"

#include <algorithm>

namespace cdiff::planners {
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
