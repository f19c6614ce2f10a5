// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/two_stage_pid/two_stage_pid.h"

#include <algorithm>
#include <utility>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "planners/diffusion/diffusion_planner.h"

namespace cdiff::planners {
namespace {

constexpr Eigen::Index kSpacing = 10;      // [rows] 1 s
constexpr Eigen::Index kShortSpacing = 5;  // [rows] of plans shorter than 2 s

/// Places of a plan a fixed time apart.
struct Thinned {
  Eigen::MatrixX2d places;
  double time = traffic::kRolloutStep;  ///< from one to the next [s]
};

Thinned thin(const Eigen::MatrixX2d& places) {
  const Eigen::Index wanted = places.rows() < 2 * kSpacing ? kShortSpacing : kSpacing;
  const Eigen::Index spacing = std::min(wanted, places.rows());
  Thinned thinned;
  if (spacing == 0) return thinned;
  thinned.places.resize(places.rows() / spacing, 2);
  for (Eigen::Index i = 0; i < thinned.places.rows(); ++i)
    thinned.places.row(i) = places.row((i + 1) * spacing - 1);
  thinned.time = static_cast<double>(spacing) * traffic::kRolloutStep;
  return thinned;
}

double meanSpeed(const Thinned& plan) {
  if (plan.places.rows() == 0) return 0.0;
  double length = 0.0;
  Eigen::RowVector2d last = Eigen::RowVector2d::Zero();
  for (const auto& place : plan.places.rowwise()) {
    length += (place - last).norm();
    last = place;
  }
  return length / (static_cast<double>(plan.places.rows()) * plan.time);
}

}  // namespace

void TrajectoryTrackerOptions::describe(core::OptionsVisitor& visitor) {
  pids.describe(visitor);
  visitor.number({"look_ahead_time", "s", "Look-ahead per speed."}, look_ahead_time, 0.0, 10.0);
  visitor.number({"look_ahead_distance", "m", "Look-ahead at standstill, before its limits."},
                 look_ahead_distance, 0.0, 50.0);
  visitor.number({"look_ahead_minimum", "m", "Least look-ahead."}, look_ahead_minimum, 0.1, 50.0);
  visitor.number({"look_ahead_maximum", "m", "Largest look-ahead."}, look_ahead_maximum, 0.1, 50.0);
}

void TrajectoryTrackerOptions::validate() const {
  if (look_ahead_minimum <= look_ahead_maximum) return;
  throw core::InputError(
      "two_stage_pid: look_ahead_minimum is " + core::formatNumber(look_ahead_minimum) +
      " m, but look_ahead_maximum only " + core::formatNumber(look_ahead_maximum) + " m");
}

double TrajectoryTrackerOptions::lookAhead(double speed) const {
  return std::clamp(look_ahead_time * speed + look_ahead_distance, look_ahead_minimum,
                    look_ahead_maximum);
}

TrajectoryTracker::TrajectoryTracker(const TrajectoryTrackerOptions& options)
    : options_(options), pids_(options.pids) {
  options_.validate();
}

/// `places` are the thinned ones, at least one.
double TrajectoryTracker::turnError(double speed, const Eigen::MatrixX2d& places) const {
  Eigen::Index aim = 0;
  (places.rowwise().norm().array() - options_.lookAhead(speed)).abs().minCoeff(&aim);
  return planning::turnErrorToward(places.row(aim).transpose());
}

traffic::ControlAction TrajectoryTracker::track(double speed, const Eigen::MatrixX2d& places) {
  const Thinned plan = thin(places);
  const double desired = meanSpeed(plan);
  const bool steers = !pids_.brakes(speed, desired) && speed >= kStandstill;
  return pids_.track(speed, desired, steers ? turnError(speed, plan.places) : 0.0);
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
                         const TrajectoryTrackerOptions& options)
    : planner_(std::move(planner)), options_(options) {
  options_.validate();
}

std::vector<planning::PlannedAction> TwoStagePid::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions = planner_->plan(snapshot, tasks);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!actions[i].fault.empty()) continue;
    const traffic::VehicleState& state = tasks[i].vehicle->state;
    TrajectoryTracker& tracker =
        trackers_.keep(tasks[i].vehicle->id, [&] { return TrajectoryTracker(options_); });
    actions[i].action = tracker.track(state.speed, placesOf(actions[i].rollout, state.pose()));
  }
  trackers_.forgetOthers();
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
