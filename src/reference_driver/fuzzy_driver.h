// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "reference_driver/conflict.h"
#include "reference_driver/reference_driver.h"

namespace cdiff::reference_driver {

/// Constants of the fuzzy safety model (JRC's FSM, UN R157 Annex 3).
struct FuzzyDriverOptions {
  double reaction_time = 0.75;       ///< tau [s]
  double comfortable_braking = 4.0;  ///< [m/s^2]
  double hardest_braking = 6.0;      ///< [m/s^2]
  double lead_braking = 7.0;         ///< expected of the vehicle ahead [m/s^2]
  double margin = 2.0;               ///< [m]
  double jerk = 12.65;               ///< of the brake [m/s^3]
  double look_ahead = 4.0;           ///< of vehicles that come into its way [s]
};

/// Proactive fuzzy surrogate: 0 (safe) to 1 for a gap [m] to a vehicle ahead; linear between
/// d_unsafe = tau v + v^2 / 12 - v_l^2 / 14 and d_safe = tau v + v^2 / 8 - v_l^2 / 14 + 2 on gap
/// - 2.
double proactiveSurrogate(const FuzzyDriverOptions& options, double gap, double speed,
                          double lead_speed);

/// Critical fuzzy surrogate: 0 to 1 by what the speeds come to in the reaction time under the
/// present acceleration w (at least -4): linear between
/// (v + tau w / 2 - v_l) tau + (v + tau w - v_l)^2 / 12 and the same with / 8, on gap - 2.
double criticalSurrogate(const FuzzyDriverOptions& options, double gap, const OwnMotion& own,
                         double lead_speed);

/// Driver FSM: it brakes with 4 + 2 CFS where the critical surrogate is positive, else with 4 PFS,
/// the reaction time after the demand. It takes every vehicle that it meets within `look_ahead`
/// (conflict.h) for one ahead at the place where it comes in: so it anticipates.
class FuzzyDriver final : public ReferenceDriver {
 public:
  explicit FuzzyDriver(const FuzzyDriverOptions& options = {}) : options_(options) {}

  double brake(const OwnMotion& own, const std::vector<SeenVehicle>& seen,
               double duration) override;
  std::unique_ptr<ReferenceDriver> clone() const override;

 private:
  double demand(const OwnMotion& own, const SeenVehicle& other) const;

  FuzzyDriverOptions options_;
  double demand_since_ = -1.0;  ///< [s]; negative: there is none
  BrakeRamp ramp_;
};

}  // namespace cdiff::reference_driver
