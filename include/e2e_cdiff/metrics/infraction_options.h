// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>

#include "e2e_cdiff/core/options.h"

namespace cdiff::metrics {

/// How infractions lower the driving score. Defaults: those of RIFT and Bench2Drive.
struct ScoreRules {
  bool charges = false;       ///< 1 / (1 + sum of charges) instead of a product of factors
  bool speed_counts = false;  ///< whether the minimum speed enters
};

/// What counts as an infraction of the ego and how the driving score charges it: rules of a
/// protocol preset (SI units).
/// Defaults: rift_dev10. Described without a group of its own: the keys lie beside the protocol's.
struct InfractionOptions {
  double collision_repeat_time = 5.0;  ///< the same partner again before is the same collision [s]
  double collision_repeat_distance = 5.0;  ///< nearer to the last collision is the same one [m]
  double collision_minimum_speed = 0.1;    ///< a slower ego did not cause its contact [m/s]
  double outside_lane_margin = 0.5;        ///< beyond a lane's border [m]
  double wrong_lane_angle = 120.0;  ///< a lane at a larger angle to the ego is a wrong one [deg]
  double stop_sign_distance = 4.0;  ///< before the line, within which to stop [m]
  double stop_sign_speed = 0.1;     ///< slower has stopped [m/s]
  std::int64_t speed_checkpoints = 20;  ///< stretches of the route with a minimum speed
  bool speed_counts = false;            ///< whether the minimum speed enters the score
  std::string penalty = "factors";      ///< factors | charges

  void describe(core::OptionsVisitor& visitor);
  ScoreRules scoreRules() const;
};

}  // namespace cdiff::metrics
