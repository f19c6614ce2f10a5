// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/two_stage_pid/two_stage_pid.h"

#include <utility>

#include "e2e_cdiff/planning/planner.h"
#include "planners/diffusion/diffusion_descriptor.h"

namespace cdiff::planners {
namespace {

/// Planned places in the body frame that the vehicle has now [T, 2].
Eigen::MatrixX2d placesOf(const std::vector<planning::RolloutPoint>& rollout,
                          const geometry::Pose2d& pose) {
  Eigen::MatrixX2d places(static_cast<Eigen::Index>(rollout.size()), 2);
  for (Eigen::Index row = 0; row < places.rows(); ++row) {
    const traffic::VehicleState& state = rollout[static_cast<std::size_t>(row)].state;
    places.row(row) = pose.toBody(state.position).transpose();
  }
  return places;
}

}  // namespace

TwoStagePid::TwoStagePid(std::unique_ptr<DiffusionPlanner> planner,
                         const TrajectoryTrackerOptions& options)
    : planner_(std::move(planner)), options_(options) {
  options_.validate();
}

std::vector<planning::PlannedAction> TwoStagePid::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions = planner_->plan(snapshot, tasks);
  std::map<std::string, TrajectoryTracker> kept;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!actions[i].fault.empty()) continue;
    const traffic::VehicleState& state = tasks[i].vehicle->state;
    const std::string& id = tasks[i].vehicle->id;
    const auto known = trackers_.find(id);
    auto& tracker =
        kept.emplace(id, known == trackers_.end() ? TrajectoryTracker(options_) : known->second)
            .first->second;
    actions[i].action = tracker.track(state.speed, placesOf(actions[i].rollout, state.pose()));
  }
  trackers_ = std::move(kept);
  return actions;
}

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
