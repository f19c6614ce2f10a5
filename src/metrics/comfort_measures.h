// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// How CBVs move at decision ticks: speed [m/s], magnitude of acceleration [m/s^2], jerk [m/s^3]
/// and the share of decisions beyond nuPlan's comfort limits [%].
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "metrics/cbv_measures.h"

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

class ComfortMeasures {
 public:
  /// `decision_period` [s].
  explicit ComfortMeasures(double decision_period) : decision_period_(decision_period) {}

  /// One decision tick: all CBVs. A value that is not finite is left out.
  void observe(const std::vector<CbvSighting>& cbvs);
  DistributionMeasure speed() const;
  DistributionMeasure acceleration() const;
  /// Change of the acceleration's magnitude from one decision to the next / decision period; the
  /// first decision of a vehicle as CBV has none.
  DistributionMeasure jerk() const;
  Measure uncomfortableRatePercent() const;

 private:
  double decision_period_;
  std::map<std::string, double> last_magnitudes_;  ///< of the CBVs of the last decision
  SampleStatistics speeds_;
  SampleStatistics accelerations_;
  SampleStatistics jerks_;
  TickShare uncomfortable_;
};

}  // namespace cdiff::metrics
