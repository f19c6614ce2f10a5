// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/plant/plant.h"

#include <algorithm>

#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planning/surrounding_vehicles.h"
#include "planning/waypoint_rollout.h"

namespace cdiff::planners {

PlantOptions::PlantOptions() : WeightOptions{kPlant.planner} {
  pids.turn.kp = 0.9;
  pids.speed_error_limit = 0.25;
  pids.max_throttle = 0.75;
}

void PlantOptions::describe(core::OptionsVisitor& visitor) {
  WeightOptions::describe(visitor);
  pids.describe(visitor);
  visitor.number({"steer_damping", "", "Factor on the steering while it brakes."}, steer_damping,
                 0.0, 1.0);
  visitor.number({"least_own_speed", "m/s",
                  "Least speed that its own token shows, of weights that know their own vehicle."},
                 least_own_speed, 0.0, 20.0);
}

WaypointTracker::WaypointTracker(const PlantOptions& options)
    : steer_damping_(options.steer_damping), pids_(options.pids) {}

traffic::ControlAction WaypointTracker::track(double speed, const PlantWaypoints& waypoints) {
  const double desired = (waypoints[1] - waypoints[0]).norm() / kPlantWaypointPeriod;
  const Eigen::Vector2d aim = 0.5 * (waypoints[0] + waypoints[1]);
  const double turn_error = pids_.brakes(speed, desired) ? 0.0 : planning::turnErrorToward(aim);
  traffic::ControlAction action = pids_.track(speed, desired, turn_error);
  if (action.brake > 0.0) action.steer *= steer_damping_;
  return action;
}

namespace {

bool allFinite(const PlantWaypoints& waypoints) {
  return std::all_of(waypoints.begin(), waypoints.end(),
                     [](const Eigen::Vector2d& waypoint) { return waypoint.allFinite(); });
}

}  // namespace

PlantPlanner::PlantPlanner(const PlantOptions& options, const PlantModel& model)
    : options_(options), architecture_(model.architecture), network_(model) {}

PlantInput PlantPlanner::inputOf(const traffic::TrafficSnapshot& snapshot,
                                 const planning::PlanningTask& task, double arc_length) const {
  PlantInput input = plantInput(architecture_, snapshot, *task.vehicle, *task.route, arc_length);
  const auto least = static_cast<float>(options_.least_own_speed / kPlantSpeedScale);
  for (std::size_t i = 0; i < input.ids.size(); ++i) {
    float& speed = input.vehicles[i][kPlantSpeedAttribute];
    if (input.ids[i] == task.vehicle->id) speed = std::max(speed, least);
  }
  return input;
}

std::vector<planning::PlannedAction> PlantPlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions;
  std::vector<PlantInput> inputs;
  std::vector<std::size_t> planned;  // places of the tasks that the inputs are of
  for (const planning::PlanningTask& task : tasks) {
    const std::string fault = planning::faultOf(snapshot, task);
    actions.push_back(planning::failSafeAction(task, fault));
    if (!fault.empty()) continue;
    Memory& memory = memories_.keep(task.vehicle->id, [&] {
      return Memory{{}, WaypointTracker(options_)};
    });
    memory.follower.update(*task.route, task.vehicle->state.position);
    inputs.push_back(inputOf(snapshot, task, memory.follower.arcLength()));
    planned.push_back(actions.size() - 1);
  }
  memories_.forgetOthers();
  const std::vector<PlantOutput> outputs = network_.forward(inputs);
  for (std::size_t i = 0; i < planned.size(); ++i)
    conclude(tasks[planned[i]], inputs[i], outputs[i], actions[planned[i]]);
  return actions;
}

void PlantPlanner::conclude(const planning::PlanningTask& task, const PlantInput& input,
                            const PlantOutput& output, planning::PlannedAction& planned) {
  if (!allFinite(output.waypoints)) {
    planned = planning::failSafeAction(task, "a waypoint of its plan is not finite");
    return;
  }
  const traffic::VehicleState& state = task.vehicle->state;
  planned.action = memories_.at(planned.vehicle_id).tracker.track(state.speed, output.waypoints);
  planned.rollout =
      planning::rolloutAlong(state, {output.waypoints.begin(), output.waypoints.end()},
                             kPlantWaypointPeriod, planned.action);
  for (std::size_t i = 0; i < input.ids.size(); ++i) {
    if (input.ids[i] == planned.vehicle_id) continue;
    planned.attended.push_back({input.ids[i], static_cast<double>(output.attention[i])});
  }
}

planning::PlannerDescriptor plantDescriptor() {
  planning::PlannerDescriptor descriptor =
      learnedDescriptor<PlantOptions>(kPlant, {"vehicles_route", "one pass of the network"});
  descriptor.title = "PlanT";
  descriptor.help = "a transformer over the boxes around it that imitates PDM-Lite.";
  descriptor.make = [](const planning::PlannerParts& parts) {
    const auto& options = parts.options.of<PlantOptions>();
    return std::make_unique<PlantPlanner>(options, readPlantModel(options.folder()));
  };
  return descriptor;
}

}  // namespace cdiff::planners
