// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <vector>

#include "planners/camera_ego/training/set_losses.h"

namespace cdiff::planners {

// The four losses of plans that VAD publishes, and that of its forecasts (Jiang et al. 2023), with
// their constants. The three constraints look at what the network sees itself, as there, without a
// gradient into it.

/// Weights and thresholds.
struct PlanLossOptions {
  double imitation = 1.0;  ///< L1 to where the ego was driven
  double boundary = 1.0;
  double collision = 1.0;
  double direction = 0.5;
  double forecast = 0.2;        ///< L1 of the best way
  double forecast_score = 0.2;  ///< focal loss of which way that is

  static constexpr double kSure = 0.5;             ///< what is less sure is not looked at
  static constexpr double kBoundaryReach = 1.0;    ///< [m]
  static constexpr double kCollisionReach = 3.0;   ///< of agents that are looked at [m]
  static constexpr double kCollisionAcross = 1.5;  ///< [m]
  static constexpr double kCollisionAlong = 3.0;   ///< [m]
  static constexpr double kLaneReach = 2.0;        ///< [m]
  static constexpr double kLeastWay = 1.0;         ///< shorter plans have no direction [m]
};

/// The commanded plans [B, 6, 2] of all [B, 6 commands, 6, 2].
at::Tensor commandedPlans(const at::Tensor& plans, const std::vector<const EgoExample*>& examples);

/// Mean absolute error of the coordinates of known waypoints [m].
at::Tensor imitationLoss(const at::Tensor& plans, const std::vector<const EgoExample*>& examples);

/// What plans are held against (body frame [m], no gradients). S segments, A agents.
struct DetectedSurroundings {
  at::Tensor edge_begin, edge_end;  ///< [B, S, 2]
  at::Tensor edge_sure;             ///< [B, S]: 1 or 0
  at::Tensor lane_begin, lane_end;  ///< centerlines, likewise
  at::Tensor lane_sure;
  at::Tensor agents;      ///< [B, A, 6, 2] where they will be by their best way
  at::Tensor agent_sure;  ///< [B, A]
};

/// Mean over waypoints of max(0, 1 m - distance to the nearest edge), 0 from where the plan crosses
/// an edge on. Published: lines of the class "solid, double"; ours: edges of the drivable area.
at::Tensor boundaryLoss(const at::Tensor& plans, const DetectedSurroundings& seen);
/// Mean over waypoints of max(0, 1.5 m - |dy|) + max(0, 3 m - |dx|) to the nearest agent within 3
/// m.
at::Tensor collisionLoss(const at::Tensor& plans, const DetectedSurroundings& seen);
/// Mean over waypoints of the angle between plan and nearest lane within 2 m, either way along it;
/// plans of less than 1 m count nothing. Published: lines of the class "broken"; ours: centerlines.
at::Tensor directionLoss(const at::Tensor& plans, const DetectedSurroundings& seen);

/// Ways [B, A, 6, 6, 2] and logits [B, A, 6] of matched agents: L1 of the way whose last known
/// place is nearest to the true one, and focal loss of which one that is.
struct ForecastLoss {
  at::Tensor places;
  at::Tensor kind;
};
ForecastLoss forecastLoss(const at::Tensor& ways, const at::Tensor& logits,
                          const std::vector<const EgoExample*>& examples,
                          const QueryMatches& matches, const PlanLossOptions& options);

}  // namespace cdiff::planners
