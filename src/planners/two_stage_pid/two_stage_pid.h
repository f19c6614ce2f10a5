// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "planners/diffusion/diffusion_planner.h"
#include "planners/two_stage_pid/pdm_lite_tracker.h"
#include "planning/plan_tracker.h"
#include "planning/vehicle_memory.h"

namespace cdiff::planners {

/// Options of the planner: those of its tracker, which may be `pdm_lite`, too. That one has
/// PDM-Lite's own constants; of the keys beside it only speed_horizon counts.
struct TwoStagePidOptions : planning::PlanTrackerOptions {
  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError also for a key that `tracker: pdm_lite` does not have and that is not as
  /// `tuned` has it.
  void validate() const;
};

/// The diffusion planner with its denoised actions left out (the paper's two-stage variant): the
/// planned states, in the vehicle's body frame, are followed by a tracker. Same model, guidance and
/// noise as `diffusion`, so that only the execution differs.
class TwoStagePid : public planning::Planner {
 public:
  /// Takes over `planner`, which makes the plans.
  TwoStagePid(std::unique_ptr<DiffusionPlanner> planner, const TwoStagePidOptions& options);

  /// The action is the tracker's; rollout, guidance and state mismatch are those of the plan, its
  /// denoised actions included. A vehicle with a fault keeps the fail-safe action and its tracker
  /// starts over, as does that of a vehicle left out of a decision.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;
  void setGuidance(const guidance::GuidanceOptions& guidance) override {
    planner_->setGuidance(guidance);
  }

 private:
  using Tracker = std::variant<planning::PlanTracker, PdmLiteTracker>;
  Tracker makeTracker() const;

  std::unique_ptr<DiffusionPlanner> planner_;
  TwoStagePidOptions options_;
  planning::VehicleMemory<Tracker> trackers_;
};

}  // namespace cdiff::planners
