// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "planners/diffusion/diffusion_planner.h"
#include "planners/two_stage_pid/trajectory_tracker.h"

namespace cdiff::planners {

/// The diffusion planner with its denoised actions left out (the paper's two-stage variant): the
/// planned states, in the vehicle's body frame, are followed by a PID tracker. Same model, guidance
/// and noise as `diffusion`, so that only the execution differs.
class TwoStagePid : public planning::Planner {
 public:
  /// Takes over `planner`, which makes the plans.
  TwoStagePid(std::unique_ptr<DiffusionPlanner> planner, const TrajectoryTrackerOptions& options);

  /// The action is the tracker's; rollout, guidance and state mismatch are those of the plan, its
  /// denoised actions included. A vehicle with a fault keeps the fail-safe action and its tracker
  /// starts over, as does that of a vehicle left out of a decision.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;
  bool needsImages() const override { return true; }

 private:
  std::unique_ptr<DiffusionPlanner> planner_;
  TrajectoryTrackerOptions options_;
  std::map<std::string, TrajectoryTracker> trackers_;  ///< by vehicle
};

}  // namespace cdiff::planners
