// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the diffusion planner remembers of a vehicle, and what it knows of one at a decision.
#pragma once

#include "guidance/total_objective.h"
#include "planners/diffusion/diffusion_planner.h"
#include "planners/diffusion/last_plan.h"

namespace cdiff::planners {

/// What is remembered of a vehicle between decisions.
struct DiffusionPlanner::Memory {
  planning::RouteFollower follower;
  ImageWatch watch;
  std::optional<LastPlan> plan;
  std::vector<float> features;  ///< of the last image
  std::uint64_t features_hash = 0;
};

/// One vehicle of this decision.
struct DiffusionPlanner::Situation {
  const planning::PlanningTask* task = nullptr;
  Memory* memory = nullptr;
  diffusion::Context context;
  guidance::GuidanceScene scene;
  guidance::OtherMotion other;
  std::optional<traffic::Rollout> previous;   ///< last plan as seen from here, metric
  std::optional<diffusion::Trajectory> warm;  ///< the same, normalised, where it fits
  std::vector<std::unique_ptr<guidance::TotalObjective>> objectives;  ///< one per candidate
  traffic::Rollout plan;                                              ///< the chosen one
  guidance::GuidanceReport report;
};

}  // namespace cdiff::planners
