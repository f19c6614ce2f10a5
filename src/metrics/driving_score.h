// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Driving score [%] of CARLA's leaderboard: route completion x penalty, never negative; the
/// penalty is a product of factors (2.0) or 1 / (1 + sum of charges) (2.1).
#pragma once

#include <cstddef>
#include <vector>

#include "e2e_cdiff/metrics/infraction_options.h"

namespace cdiff::metrics {

/// What happened on a route.
struct Infractions {
  std::size_t pedestrian_collisions = 0;
  std::size_t vehicle_collisions = 0;
  std::size_t static_collisions = 0;
  std::size_t red_lights = 0;
  std::size_t stop_signs = 0;
  std::size_t scenario_timeouts = 0;
  std::size_t yields_failed = 0;  ///< to emergency vehicles
  std::vector<double>
      minimum_speed_percent;           ///< per checkpoint: own mean speed / that of the traffic [%]
  double outside_lanes_percent = 0.0;  ///< part of the completed route outside the lanes, 0 to 100
};

/// In [0, 1]; 1 without infractions.
double infractionPenalty(const Infractions& infractions, const ScoreRules& rules);

/// In percent, from a route completion in percent.
double drivingScore(double route_completion_percent, const Infractions& infractions,
                    const ScoreRules& rules);

}  // namespace cdiff::metrics
