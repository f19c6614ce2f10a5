// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "planners/camera_ego/bev_grid.h"
#include "planners/uniad_mini/uniad_mini_weights.h"

namespace cdiff::planners {

/// How plans are moved away from what is probably occupied.
struct PlanAdjustmentOptions {
  bool adjust = true;
  double occupied = 0.5;    ///< probability from which a cell counts
  double reach = 5.0;       ///< of cells around a waypoint [m]
  double deviation = 1.0;   ///< sigma of a cell's repulsion [m]
  double weight = 5.0;      ///< of repulsion
  std::int64_t steps = 20;  ///< of gradient descent
  double step_length = 0.1;

  void describe(core::OptionsVisitor& visitor);
};

/// Centers of occupied cells by occupancy step (body frame [m]).
using OccupiedPlaces = std::array<std::vector<Eigen::Vector2d>, kOccupancySteps>;

/// Cells whose probability is at least `least`.
std::vector<Eigen::Vector2d> occupiedPlaces(const BevGrid& bev,
                                            const std::vector<float>& probability, double least);

/// What is minimized for a waypoint tau that was planned at `planned` (Hu et al. 2023): |tau -
/// planned|^2 + weight / (sigma sqrt(2 pi)) sum over occupied places within reach of `planned` of
/// exp(-d^2 / (2 sigma^2)), and its gradient.
struct RepulsionCost {
  double value = 0.0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
};
RepulsionCost repulsionCost(const Eigen::Vector2d& waypoint, const Eigen::Vector2d& planned,
                            const std::vector<Eigen::Vector2d>& occupied,
                            const PlanAdjustmentOptions& options);

/// The plan after some steps of gradient descent on that cost, where UniAD solves it by IPOPT.
/// Waypoint i looks at occupancy step i + 1, those beyond the last step at that one. A step that
/// does not lower the cost is halved.
EgoWaypoints adjustedPlan(const EgoWaypoints& planned, const OccupiedPlaces& occupied,
                          const PlanAdjustmentOptions& options);

}  // namespace cdiff::planners
