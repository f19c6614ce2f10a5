// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/driving_score.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cdiff::metrics {
namespace {

/// One kind of infraction: how often, the factor of 2.0, the charge of 2.1.
struct Kind {
  std::size_t count;
  double factor;
  double charge;
};

std::array<Kind, 7> kindsOf(const Infractions& infractions) {
  return {Kind{infractions.pedestrian_collisions, 0.50, 1.0},
          Kind{infractions.vehicle_collisions, 0.60, 0.7},
          Kind{infractions.static_collisions, 0.65, 0.6},
          Kind{infractions.red_lights, 0.70, 0.4},
          Kind{infractions.stop_signs, 0.80, 0.25},
          Kind{infractions.scenario_timeouts, 0.70, 0.4},
          Kind{infractions.yields_failed, 0.70, 0.4}};
}

/// Missing part of the traffic's speed, 0 to 1, at each checkpoint.
std::vector<double> speedDeficits(const Infractions& infractions) {
  std::vector<double> deficits;
  for (const double percent : infractions.minimum_speed_percent) {
    deficits.push_back(std::clamp(1.0 - percent / 100.0, 0.0, 1.0));
  }
  return deficits;
}

double productOfFactors(const Infractions& infractions, bool minimum_speed) {
  double product = 1.0;
  for (const Kind& kind : kindsOf(infractions)) {
    product *= std::pow(kind.factor, static_cast<double>(kind.count));
  }
  if (!minimum_speed) return product;
  for (const double deficit : speedDeficits(infractions)) product *= 1.0 - 0.3 * deficit;
  return product;
}

double sumOfCharges(const Infractions& infractions, bool minimum_speed) {
  double sum = 0.0;
  for (const Kind& kind : kindsOf(infractions))
    sum += kind.charge * static_cast<double>(kind.count);
  if (!minimum_speed) return sum;
  for (const double deficit : speedDeficits(infractions)) sum += 0.4 * deficit;
  return sum;
}

}  // namespace

double infractionPenalty(const Infractions& infractions, const ScoreRules& rules) {
  const double inside = std::clamp(1.0 - infractions.outside_lanes_percent / 100.0, 0.0, 1.0);
  if (rules.charges) return inside / (1.0 + sumOfCharges(infractions, rules.speed_counts));
  return inside * productOfFactors(infractions, rules.speed_counts);
}

double drivingScore(double route_completion_percent, const Infractions& infractions,
                    const ScoreRules& rules) {
  return std::max(0.0, route_completion_percent * infractionPenalty(infractions, rules));
}

}  // namespace cdiff::metrics
