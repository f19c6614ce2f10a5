// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/plan_adjustment.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {

void PlanAdjustmentOptions::describe(core::OptionsVisitor& visitor) {
  visitor.flag({"adjust", "", "Whether plans are moved away from occupied cells."}, adjust);
  visitor.number({"occupied", "", "Probability from which a cell counts as occupied."}, occupied,
                 0.0, 1.0);
  visitor.number({"reach", "m", "Distance of occupied cells that count."}, reach, 0.0, 50.0);
  visitor.number({"deviation", "m", "Standard deviation of a cell's repulsion."}, deviation, 0.1,
                 10.0);
  visitor.number({"weight", "", "Weight of repulsion."}, weight, 0.0, 1000.0);
  visitor.integer({"steps", "", "Steps of gradient descent."}, steps, 0, 1000);
  visitor.number({"step_length", "", "Length of a step per gradient."}, step_length, 1e-4, 0.5);
}

std::vector<Eigen::Vector2d> occupiedPlaces(const BevGrid& bev,
                                            const std::vector<float>& probability, double least) {
  std::vector<Eigen::Vector2d> places;
  for (std::size_t cell = 0; cell < probability.size(); ++cell) {
    if (static_cast<double>(probability[cell]) >= least)
      places.push_back(bev.center(static_cast<std::int64_t>(cell)));
  }
  return places;
}

RepulsionCost repulsionCost(const Eigen::Vector2d& waypoint, const Eigen::Vector2d& planned,
                            const std::vector<Eigen::Vector2d>& occupied,
                            const PlanAdjustmentOptions& options) {
  const double variance = options.deviation * options.deviation;
  const double scale = options.weight / (options.deviation * std::sqrt(2.0 * core::kPi));
  RepulsionCost cost{(waypoint - planned).squaredNorm(), 2.0 * (waypoint - planned)};
  for (const Eigen::Vector2d& place : occupied) {
    if ((place - planned).norm() > options.reach) continue;
    const Eigen::Vector2d from = waypoint - place;
    const double repulsion = scale * std::exp(-0.5 * from.squaredNorm() / variance);
    cost.value += repulsion;
    cost.gradient -= repulsion / variance * from;
  }
  return cost;
}

EgoWaypoints adjustedPlan(const EgoWaypoints& planned, const OccupiedPlaces& occupied,
                          const PlanAdjustmentOptions& options) {
  EgoWaypoints plan = planned;
  for (std::size_t i = 0; options.adjust && i < plan.size(); ++i) {
    const auto& places = occupied[std::min(i + 1, occupied.size() - 1)];
    RepulsionCost cost = repulsionCost(plan[i], planned[i], places, options);
    double length = options.step_length;
    for (std::int64_t step = 0; step < options.steps; ++step) {
      const Eigen::Vector2d next = plan[i] - length * cost.gradient;
      const RepulsionCost there = repulsionCost(next, planned[i], places, options);
      if (there.value > cost.value) {
        length *= 0.5;
        continue;
      }
      plan[i] = next;
      cost = there;
    }
  }
  return plan;
}

}  // namespace cdiff::planners
