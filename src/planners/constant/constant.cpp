// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/constant/constant.h"

#include <algorithm>
#include <memory>

#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {

void ConstantSpeedOptions::describe(core::OptionsVisitor& visitor) {
  visitor.number({"speed", "m/s", "Speed that it keeps, at most v*; 0: it stands still."}, speed,
                 0.0, 60.0);
}

ConstantSpeed::ConstantSpeed(const ConstantSpeedOptions& options,
                             const dynamics::BicycleModelOptions& vehicle)
    : options_(options), model_(vehicle) {
  options_.validate();
}

std::vector<planning::PlannedAction> ConstantSpeed::plan(
    const traffic::TrafficSnapshot&, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions;
  for (const planning::PlanningTask& task : tasks) {
    const std::string fault = planning::faultOf(task);
    actions.push_back(planning::failSafeAction(task, fault));
    if (!fault.empty()) continue;
    DriverState& driver = drivers_.keep(task.vehicle->id, [] { return DriverState(); });
    actions.back().action = actionOf(task, driver);
  }
  drivers_.forgetOthers();
  return actions;
}

traffic::ControlAction ConstantSpeed::actionOf(const planning::PlanningTask& task,
                                               DriverState& driver) const {
  constexpr double kMostChange = 3.0 * traffic::kRolloutStep;  // [m/s]
  const traffic::VehicleState& state = task.vehicle->state;
  const double steer = steerAlong(*task.route, state, driver);
  const double kept_speed = std::min(options_.speed, task.target_speed);
  const bool ended = driver.follower.arcLength() >= task.route->length();
  if (ended || kept_speed <= 0.0) return {0.0, steer, 1.0};
  const double change = std::clamp(kept_speed - state.speed, -kMostChange, kMostChange);
  traffic::ControlAction action =
      dynamics::inferAction(model_, {state.speed, state.speed + change, 0.0});
  action.steer = steer;
  return action;
}

planning::PlannerDescriptor constantDescriptor() {
  planning::PlannerDescriptor descriptor;
  descriptor.name = "constant";
  descriptor.title = "Constant speed";
  descriptor.help = "keeps one speed along its route, whatever is ahead; a baseline.";
  descriptor.options = planning::makePlannerOptions<ConstantSpeedOptions>;
  descriptor.make = [](const planning::PlannerParts& parts) {
    return std::make_unique<ConstantSpeed>(parts.options.of<ConstantSpeedOptions>(), parts.vehicle);
  };
  return descriptor;
}

}  // namespace cdiff::planners
