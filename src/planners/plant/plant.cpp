// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/plant/plant.h"

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "e2e_cdiff/core/angle.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {

void PlantOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text(
      {"weights", "", "Folder of its weights; a plain name is one in weights/ of the package."},
      weights, {});
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
  visitor.number({"steer_damping", "", "Factor on the steering while it brakes."}, steer_damping,
                 0.0, 1.0);
}

std::filesystem::path PlantOptions::folder() const {
  const std::filesystem::path given(weights);
  return given == given.filename() ? core::shareFolder() / "weights" / given : given;
}

WaypointTracker::WaypointTracker(const PlantOptions& options)
    : options_(options),
      turn_(options.turn_kp, options.turn_ki, options.turn_kd, options.window),
      speed_(options.speed_kp, options.speed_ki, options.speed_kd, options.window) {}

traffic::ControlAction WaypointTracker::track(double speed, const PlantWaypoints& waypoints) {
  const double desired = (waypoints[1] - waypoints[0]).norm() / kPlantWaypointPeriod;
  const bool brake = desired < options_.brake_speed || speed > options_.brake_ratio * desired;
  const Eigen::Vector2d aim = 0.5 * (waypoints[0] + waypoints[1]);
  const double bearing = std::atan2(aim.y(), aim.x()) / (0.5 * core::kPi);
  const double turn = turn_.update(brake ? 0.0 : bearing);
  const double drive = speed_.update(std::clamp(desired - speed, 0.0, options_.speed_error_limit));
  traffic::ControlAction action;
  action.steer = (brake ? options_.steer_damping : 1.0) * std::clamp(turn, -1.0, 1.0);
  action.throttle = brake ? 0.0 : std::clamp(drive, 0.0, options_.max_throttle);
  action.brake = brake ? 1.0 : 0.0;
  return action;
}

namespace {

/// The straight lines from waypoint to waypoint as states 0.1 s apart, in the map frame.
std::vector<planning::RolloutPoint> rolloutOf(const traffic::VehicleState& start,
                                              const PlantWaypoints& waypoints,
                                              const traffic::ControlAction& action) {
  constexpr int kSteps = 5;             // from one waypoint to the next
  constexpr double kStandstill = 0.05;  // shorter lines have no direction [m]
  std::vector<planning::RolloutPoint> rollout;
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  double heading = start.heading;
  for (const Eigen::Vector2d& waypoint : waypoints) {
    const Eigen::Vector2d line = waypoint - last;
    if (line.norm() > kStandstill)
      heading = core::wrapAngle(start.heading + std::atan2(line.y(), line.x()));
    for (int step = 1; step <= kSteps; ++step) {
      traffic::VehicleState state = start;
      state.position = start.pose().toMap(last + line * step / kSteps);
      state.heading = heading;
      state.speed = line.norm() / kPlantWaypointPeriod;
      rollout.push_back({state, action});
    }
    last = waypoint;
  }
  return rollout;
}

bool allFinite(const PlantWaypoints& waypoints) {
  return std::all_of(waypoints.begin(), waypoints.end(),
                     [](const Eigen::Vector2d& waypoint) { return waypoint.allFinite(); });
}

}  // namespace

PlantPlanner::PlantPlanner(const PlantOptions& options, const PlantModel& model)
    : options_(options), architecture_(model.architecture), network_(model) {}

std::string PlantPlanner::faultOf(const traffic::TrafficSnapshot& snapshot,
                                  const planning::PlanningTask& task) const {
  if (!planning::isFinite(task.vehicle->state)) return "its state is not finite";
  if (task.route == nullptr || task.route->empty()) return "it has no route";
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    if (!planning::isFinite(other.state)) return "the state of '" + other.id + "' is not finite";
  }
  return {};
}

std::vector<planning::PlannedAction> PlantPlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions;
  std::vector<PlantInput> inputs;
  std::vector<std::size_t> planned;  // places of the tasks that the inputs are of
  std::map<std::string, Memory> kept;
  for (const planning::PlanningTask& task : tasks) {
    const std::string& id = task.vehicle->id;
    actions.push_back({task.slot, id, traffic::ControlAction::failSafe(), {}});
    const std::string fault = faultOf(snapshot, task);
    if (!fault.empty()) {
      actions.back().fault = "vehicle '" + id + "': " + fault + "; full braking instead";
      continue;
    }
    auto known = memories_.extract(id);
    if (!known.empty()) kept.insert(std::move(known));
    Memory& memory = kept.try_emplace(id, Memory{{}, WaypointTracker(options_)}).first->second;
    memory.follower.update(*task.route, task.vehicle->state.position);
    inputs.push_back(plantInput(architecture_, snapshot, *task.vehicle, *task.route,
                                memory.follower.arcLength()));
    planned.push_back(actions.size() - 1);
  }
  memories_ = std::move(kept);
  const std::vector<PlantOutput> outputs = network_.forward(inputs);
  for (std::size_t i = 0; i < planned.size(); ++i)
    conclude(tasks[planned[i]], inputs[i], outputs[i], actions[planned[i]]);
  return actions;
}

void PlantPlanner::conclude(const planning::PlanningTask& task, const PlantInput& input,
                            const PlantOutput& output, planning::PlannedAction& planned) {
  if (!allFinite(output.waypoints)) {
    planned.fault = "vehicle '" + planned.vehicle_id +
                    "': a waypoint of its plan is not finite; full braking instead";
    return;
  }
  const traffic::VehicleState& state = task.vehicle->state;
  planned.action = memories_.at(planned.vehicle_id).tracker.track(state.speed, output.waypoints);
  planned.rollout = rolloutOf(state, output.waypoints, planned.action);
  for (std::size_t i = 0; i < input.ids.size(); ++i) {
    if (input.ids[i] == planned.vehicle_id) continue;
    planned.attended.push_back({input.ids[i], static_cast<double>(output.attention[i])});
  }
}

planning::PlannerDescriptor plantDescriptor() {
  planning::PlannerDescriptor descriptor;
  descriptor.name = "plant";
  descriptor.title = "PlanT";
  descriptor.help = "a transformer over the boxes around it that imitates PDM-Lite.";
  descriptor.options = planning::makePlannerOptions<PlantOptions>;
  descriptor.make = [](const planning::PlannerParts& parts) {
    const auto& options = parts.options.of<PlantOptions>();
    return std::make_unique<PlantPlanner>(options, readPlantModel(options.folder()));
  };
  descriptor.network = [](const planning::PlannerOptionsTable& table,
                          const guidance::GuidanceOptions&) -> planning::NetworkFacts {
    return {table.of<PlantOptions>().weights,
            "vehicles_route",
            "one pass of the network",
            {{"plant_instruction_set", inference::toText(inference::bestInstructionSet())}}};
  };
  descriptor.weights_sha256 = [](const planning::PlannerOptionsTable& table) {
    const auto file = plantWeightFile(table.of<PlantOptions>().folder());
    return core::sha256(core::readFile(file, "weight file"));
  };
  return descriptor;
}

}  // namespace cdiff::planners
