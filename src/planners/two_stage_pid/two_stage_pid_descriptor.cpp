// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/diffusion/diffusion_descriptor.h"
#include "planners/two_stage_pid/two_stage_pid.h"

namespace cdiff::planners {

planning::PlannerDescriptor twoStagePidDescriptor() {
  planning::PlannerDescriptor descriptor = diffusionDescriptor();  // which it plans with
  descriptor.name = "two_stage_pid";
  descriptor.title = "Two-stage trajectory-then-PID";
  descriptor.help = "plans as the diffusion planner does; its tracker makes the actions.";
  descriptor.options = planning::makePlannerOptions<TrajectoryTrackerOptions>;
  descriptor.make = [](const planning::PlannerParts& parts) {
    return std::make_unique<TwoStagePid>(makeDiffusionPlanner(parts),
                                         parts.options.of<TrajectoryTrackerOptions>());
  };
  return descriptor;
}

}  // namespace cdiff::planners
