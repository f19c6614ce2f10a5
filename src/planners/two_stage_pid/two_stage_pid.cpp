// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/two_stage_pid/two_stage_pid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "planners/diffusion/diffusion_planner.h"

namespace cdiff::planners {
namespace {

constexpr double kStandstill = 0.01;       // [m/s] slower than this it does not steer
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
  visitor.number({"turn_kp", "", "Proportional gain of the steering."}, turn_kp, 0.0, 20.0);
  visitor.number({"turn_ki", "", "Gain of the mean error of the steering."}, turn_ki, 0.0, 20.0);
  visitor.number({"turn_kd", "", "Gain of the last error change of the steering."}, turn_kd, 0.0,
                 20.0);
  visitor.number({"speed_kp", "", "Proportional gain of the throttle."}, speed_kp, 0.0, 20.0);
  visitor.number({"speed_ki", "", "Gain of the mean error of the throttle."}, speed_ki, 0.0, 20.0);
  visitor.number({"speed_kd", "", "Gain of the last error change of the throttle."}, speed_kd, 0.0,
                 20.0);
  visitor.integer({"window", "", "Errors in the means."}, window, 1, 1000);
  visitor.number({"speed_error_limit", "m/s", "Largest error of the speed that counts."},
                 speed_error_limit, 0.01, 40.0);
  visitor.number({"max_throttle", "", "Largest throttle."}, max_throttle, 0.0, 1.0);
  visitor.number({"brake_speed", "m/s", "It brakes if the desired speed is lower."}, brake_speed,
                 0.0, 10.0);
  visitor.number({"brake_ratio", "", "It brakes if speed / desired speed is higher."}, brake_ratio,
                 1.0, 10.0);
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

TrajectoryTracker::TrajectoryTracker(const TrajectoryTrackerOptions& options)
    : options_(options),
      turn_(options.turn_kp, options.turn_ki, options.turn_kd, options.window),
      speed_(options.speed_kp, options.speed_ki, options.speed_kd, options.window) {
  options_.validate();
}

/// Bearing of the aimed place in units of 90 degrees; `places` are the thinned ones, at least one.
double TrajectoryTracker::turnError(double speed, const Eigen::MatrixX2d& places) const {
  const double look_ahead =
      std::clamp(options_.look_ahead_time * speed + options_.look_ahead_distance,
                 options_.look_ahead_minimum, options_.look_ahead_maximum);
  Eigen::Index aim = 0;
  (places.rowwise().norm().array() - look_ahead).abs().minCoeff(&aim);
  return std::atan2(places(aim, 1), places(aim, 0)) / (0.5 * core::kPi);
}

traffic::ControlAction TrajectoryTracker::track(double speed, const Eigen::MatrixX2d& places) {
  const Thinned plan = thin(places);
  const double desired = meanSpeed(plan);
  const bool brake = desired < options_.brake_speed || speed > options_.brake_ratio * desired;
  const bool steers = !brake && speed >= kStandstill;
  const double turn = turn_.update(steers ? turnError(speed, plan.places) : 0.0);
  const double drive = speed_.update(std::clamp(desired - speed, 0.0, options_.speed_error_limit));
  traffic::ControlAction action;
  action.steer = std::clamp(turn, -1.0, 1.0);
  action.throttle = brake ? 0.0 : std::clamp(drive, 0.0, options_.max_throttle);
  action.brake = brake ? 1.0 : 0.0;
  return action;
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
