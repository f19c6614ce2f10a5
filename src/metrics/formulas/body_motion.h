// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics {

/// Acceleration of a vehicle in its own frame [m/s^2].
struct BodyAcceleration {
  double longitudinal = 0.0;  ///< d speed / d t
  double lateral = 0.0;       ///< speed x yaw rate, positive left
  double magnitude() const;
};
BodyAcceleration bodyAcceleration(const traffic::Vehicle& vehicle);

/// nuPlan's limits as RIFT uses them: uncomfortable unless -4.05 < longitudinal < 2.40, |lateral| <
/// 4.89 and |jerk| < 8.37. Without a jerk the accelerations decide.
bool isUncomfortable(const BodyAcceleration& acceleration, const std::optional<double>& jerk);

/// How the body of one CBV moves at a decision: acceleration [m/s^2] and jerk [m/s^3].
struct BodyMotion {
  BodyAcceleration acceleration;
  std::optional<double> jerk;  ///< change of the magnitude since the last decision / period; absent
                               ///< at a vehicle's first decision as CBV
};

/// Derives the motion of each CBV's body from successive decision ticks (SI units).
class BodyMotions {
 public:
  /// `decision_period` [s].
  explicit BodyMotions(double decision_period) : decision_period_(decision_period) {}

  /// One decision tick: all CBVs, without those whose acceleration is not finite.
  std::vector<BodyMotion> observe(const std::vector<CbvSighting>& cbvs);

 private:
  double decision_period_;
  std::map<std::string, double> last_magnitudes_;  ///< of the CBVs of the last decision
};

}  // namespace cdiff::metrics
