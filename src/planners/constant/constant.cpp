// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/constant/constant.h"

#include <algorithm>
#include <memory>
#include <utility>

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
  std::map<std::string, DriverState> kept;
  for (const planning::PlanningTask& task : tasks) {
    const std::string& id = task.vehicle->id;
    actions.push_back({task.slot, id, traffic::ControlAction::failSafe(), {}});
    const bool finite = planning::isFinite(task.vehicle->state);
    if (!finite || task.route == nullptr || task.route->empty()) {
      actions.back().fault = "vehicle '" + id +
                             "': " + (finite ? "it has no route" : "its state is not finite") +
                             "; full braking instead";
      continue;
    }
    auto known = drivers_.extract(id);
    if (!known.empty()) kept.insert(std::move(known));
    actions.back().action = actionOf(task, kept[id]);
  }
  drivers_ = std::move(kept);
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
