// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/two_stage_pid/two_stage_pid.h"

#include <utility>

#include "core/option_fields.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "planners/diffusion/diffusion_descriptor.h"

namespace cdiff::planners {

void TwoStagePidOptions::describe(core::OptionsVisitor& visitor) {
  PlanTrackerOptions::describe(visitor, {kPdmLiteTracker});
}

void TwoStagePidOptions::validate() const {
  PlanTrackerOptions::validate();
  if (tracker != kPdmLiteTracker) return;
  TwoStagePidOptions unchanged;
  unchanged.tracker = tracker;
  unchanged.speed_horizon = speed_horizon;
  const auto expected = core::flatOptions(unchanged);
  std::vector<std::string> changed;
  for (const auto& [key, value] : core::flatOptions(*this)) {
    if (value != expected.at(key)) changed.push_back(key);
  }
  if (changed.empty()) return;
  throw core::InputError(
      "two_stage_pid: tracker pdm_lite has PDM-Lite's own constants and no key " +
      core::joinText(changed, ", ") +
      "; leave these keys out, or name the tracker tuned or published");
}

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
                         const TwoStagePidOptions& options)
    : planner_(std::move(planner)), options_(options) {
  options_.validate();
}

TwoStagePid::Tracker TwoStagePid::makeTracker() const {
  if (options_.tracker == kPdmLiteTracker) return PdmLiteTracker(options_.speed_horizon);
  return planning::PlanTracker(options_);
}

std::vector<planning::PlannedAction> TwoStagePid::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions = planner_->plan(snapshot, tasks);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!actions[i].fault.empty()) continue;
    const traffic::VehicleState& state = tasks[i].vehicle->state;
    Tracker& tracker = trackers_.keep(tasks[i].vehicle->id, [&] { return makeTracker(); });
    const Eigen::MatrixX2d places = placesOf(actions[i].rollout, state.pose());
    actions[i].action =
        std::visit([&](auto& follows) { return follows.track(state.speed, places); }, tracker);
  }
  trackers_.forgetOthers();
  return actions;
}

planning::PlannerDescriptor twoStagePidDescriptor() {
  planning::PlannerDescriptor descriptor = diffusionDescriptor();  // which it plans with
  descriptor.name = "two_stage_pid";
  descriptor.title = "Two-stage trajectory-then-PID";
  descriptor.help = "plans as the diffusion planner does; its tracker makes the actions.";
  descriptor.options = planning::makePlannerOptions<TwoStagePidOptions>;
  descriptor.make = [](const planning::PlannerParts& parts) {
    return std::make_unique<TwoStagePid>(makeDiffusionPlanner(parts),
                                         parts.options.of<TwoStagePidOptions>());
  };
  return descriptor;
}

}  // namespace cdiff::planners
