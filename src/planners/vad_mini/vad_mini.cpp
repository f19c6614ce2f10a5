// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/vad_mini.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planning/surrounding_vehicles.h"
#include "planning/waypoint_rollout.h"

namespace cdiff::planners {
namespace {

constexpr double kPeriod = 0.1;  // between the decisions that it was trained for [s]

std::vector<Eigen::Vector2d> toMap(const geometry::Pose2d& pose, const Eigen::Vector2d* points,
                                   std::size_t count) {
  std::vector<Eigen::Vector2d> places;
  for (std::size_t i = 0; i < count; ++i) places.push_back(pose.toMap(points[i]));
  return places;
}

planning::PerceivedVehicle vehicleOf(const DetectedAgent& agent, const traffic::VehicleState& ego) {
  planning::PerceivedVehicle vehicle;
  const auto number = [&](std::size_t i) { return static_cast<double>(agent.box[i]); };
  vehicle.score = logistic(agent.score);
  vehicle.state.position = ego.pose().toMap({number(0), number(1)});
  vehicle.state.elevation = ego.elevation + number(4);
  vehicle.state.heading = core::wrapAngle(ego.heading + std::atan2(number(6), number(7)));
  vehicle.state.speed = std::hypot(number(8), number(9));
  vehicle.dimensions = {std::exp(number(3)), std::exp(number(2)), std::exp(number(5))};
  for (std::size_t mode = 0; mode < agent.ways.size(); ++mode)
    vehicle.forecasts.push_back(
        {toMap(ego.pose(), agent.ways[mode].data(), agent.ways[mode].size()),
         logistic(agent.way_scores[mode])});
  return vehicle;
}

}  // namespace

void VadMiniOptions::describe(core::OptionsVisitor& visitor) {
  WeightOptions::describe(visitor);
  controller.describe(visitor);
  visitor.number({"frozen_image_time", "s", "The same image for so long while moving is a fault."},
                 frozen_image_time, 0.1, 60.0);
  visitor.number({"least_score", "", "Score of vehicles and lines that are shown."}, least_score,
                 0.0, 1.0);
}

planning::Perception perceptionOf(const VadMiniOutput& output, const traffic::VehicleState& ego,
                                  double least) {
  planning::Perception perception;
  for (const DetectedAgent& agent : output.agents) {
    if (logistic(agent.score) >= least) perception.vehicles.push_back(vehicleOf(agent, ego));
  }
  for (const DetectedLine& line : output.lines) {
    const auto best = std::max_element(line.scores.begin(), line.scores.end());
    if (logistic(*best) < least) continue;
    perception.lines.push_back({toText(static_cast<MapKind>(best - line.scores.begin())),
                                toMap(ego.pose(), line.points.data(), line.points.size()),
                                logistic(*best)});
  }
  return perception;
}

VadMiniPlanner::VadMiniPlanner(const VadMiniOptions& options, const VadMiniModel& model,
                               const planning::PlannerParts& parts)
    : options_(options),
      architecture_(model.architecture),
      network_(model),
      roads_(parts.context.network),
      period_(parts.context.decision_period),
      simulation_step_(parts.context.simulation_step),
      rig_(model.architecture.ego.cameras()) {
  if (std::abs(period_ - kPeriod) > 1e-9) {
    throw core::InputError("key 'decision_period' is " + core::formatNumber(period_) +
                           " s; planner 'vad_mini' was trained for 0.1 s and knows no other");
  }
  rendering::requireSameCameras(parts.rig, rig_.cameras, {"planner 'vad_mini'", parts.rig_key});
  rig_.blind = parts.rig.blind;
}

VadMiniPlanner::Memory VadMiniPlanner::newMemory() const {
  return {WaypointController(options_.controller),
          BevMemory(period_),
          RigWatch(rig_, options_.frozen_image_time, simulation_step_),
          {}};
}

std::vector<planning::PlannedAction> VadMiniPlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions;
  for (const planning::PlanningTask& task : tasks) {
    Memory& memory = memories_.keep(task.vehicle->id, [&] { return newMemory(); });
    std::string fault = planning::faultOf(task);
    if (fault.empty()) fault = memory.watch.fault(task, snapshot.tick);
    actions.push_back(planning::failSafeAction(task, fault));
    if (fault.empty()) {
      drive(task, memory, actions.back());
    } else {
      memory.bevs.forget();
    }
  }
  memories_.forgetOthers();
  return actions;
}

void VadMiniPlanner::drive(const planning::PlanningTask& task, Memory& memory,
                           planning::PlannedAction& planned) {
  const traffic::VehicleState& state = task.vehicle->state;
  const bool looks_back = architecture_.ego.past_bev;
  VadMiniInput input;
  input.images = memory.watch.pixels(task);
  input.poses = looks_back ? memory.bevs.posesAt(state) : EgoPoses{state.pose(), std::nullopt};
  input.motion = memory.bevs.motionAt(state, input.poses);
  input.past = looks_back ? memory.bevs.past() : nullptr;
  const VadMiniOutput output = network_.forward(input);
  memory.bevs.keep(state, looks_back ? network_.bevAlone(input.motion) : network_.bev(),
                   architecture_.ego.width);
  if (!output.finite()) {
    memory.bevs.forget();
    planned = planning::failSafeAction(task, "a number of its plan is not finite");
    return;
  }
  const NavigationNode& next = memory.navigation.next(roads_, *task.route, state.position);
  conclude(task, output, next, memory, planned);
}

void VadMiniPlanner::conclude(const planning::PlanningTask& task, const VadMiniOutput& output,
                              const NavigationNode& next, Memory& memory,
                              planning::PlannedAction& planned) const {
  const traffic::VehicleState& state = task.vehicle->state;
  const EgoWaypoints& plan = output.plans[static_cast<std::size_t>(next.command)];
  planned.action = memory.controller.track(state.speed, plan, state.pose().toBody(next.position));
  planned.rollout =
      planning::rolloutAlong(state, {plan.begin(), plan.end()}, kEgoWaypointPeriod, planned.action);
  planned.perception = perceptionOf(output, state, options_.least_score);
}

planning::PlannerDescriptor vadMiniDescriptor() {
  planning::PlannerDescriptor descriptor =
      learnedDescriptor<VadMiniOptions>(kVadMini, {"cameras_command", "one pass of the network"});
  descriptor.title = "VAD mini";
  descriptor.help = "a compact VAD: three cameras to a bird's-eye view, agents, map and a plan.";
  descriptor.drives_cbv = false;
  descriptor.cameras = {"front", "front_left", "front_right"};
  descriptor.rig = rendering::kFrontThreeRig;
  descriptor.make = [](const planning::PlannerParts& parts) {
    const auto& options = parts.options.of<VadMiniOptions>();
    return std::make_unique<VadMiniPlanner>(options, readVadMiniModel(options.folder()), parts);
  };
  return descriptor;
}

}  // namespace cdiff::planners
