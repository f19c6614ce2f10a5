// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "reference_driver/fuzzy_driver.h"

#include <algorithm>

namespace cdiff::reference_driver {
namespace {

/// 1 at or below `unsafe`, 0 at or above `safe`, linear between.
double between(double value, double unsafe, double safe) {
  if (value >= safe) return 0.0;
  if (value <= unsafe) return 1.0;
  return (safe - value) / (safe - unsafe);
}

}  // namespace

double proactiveSurrogate(const FuzzyDriverOptions& options, double gap, double speed,
                          double lead_speed) {
  const double reacts = options.reaction_time * speed;
  const double lead = lead_speed * lead_speed / (2.0 * options.lead_braking);
  const double square = speed * speed / 2.0;
  return between(gap - options.margin, reacts + square / options.hardest_braking - lead,
                 reacts + square / options.comfortable_braking - lead + options.margin);
}

double criticalSurrogate(const FuzzyDriverOptions& options, double gap, const OwnMotion& own,
                         double lead_speed) {
  if (own.speed <= lead_speed) return 0.0;
  const double w = std::max(own.acceleration, -options.comfortable_braking);
  const double tau = options.reaction_time;
  const double closed = (own.speed + 0.5 * tau * w - lead_speed) * tau;
  const double later = std::max(0.0, own.speed + tau * w - lead_speed);
  const double square = later * later / 2.0;
  return between(gap - options.margin, closed + square / options.hardest_braking,
                 closed + square / options.comfortable_braking);
}

double FuzzyDriver::demand(const OwnMotion& own, const SeenVehicle& other) const {
  const Conflict conflict = conflictOf(own, own.speed, other);
  if (conflict.gap <= 0.0 || !meets(conflict, options_.look_ahead, 0.0)) return 0.0;
  const double lead_speed = std::max(0.0, other.along_speed);
  const double critical = criticalSurrogate(options_, conflict.gap, own, lead_speed);
  const double range = options_.hardest_braking - options_.comfortable_braking;
  if (critical > 0.0) return options_.comfortable_braking + range * critical;
  return options_.comfortable_braking *
         proactiveSurrogate(options_, conflict.gap, own.speed, lead_speed);
}

double FuzzyDriver::brake(const OwnMotion& own, const std::vector<SeenVehicle>& seen,
                          double duration) {
  double strongest = 0.0;
  for (const SeenVehicle& other : seen) strongest = std::max(strongest, demand(own, other));
  if (strongest <= 0.0) demand_since_ = -1.0;
  if (strongest > 0.0 && demand_since_ < 0.0) demand_since_ = own.time;
  const bool acts =
      strongest > 0.0 && own.time - demand_since_ >= options_.reaction_time - kTimeTolerance;
  if (acts) return ramp_.press(strongest, options_.jerk, duration, own);
  ramp_.release();
  return 0.0;
}

std::unique_ptr<ReferenceDriver> FuzzyDriver::clone() const {
  return std::make_unique<FuzzyDriver>(*this);
}

}  // namespace cdiff::reference_driver
