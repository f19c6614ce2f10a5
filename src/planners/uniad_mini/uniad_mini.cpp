// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/uniad_mini.h"

#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/vad_mini/vad_mini.h"
#include "planning/surrounding_vehicles.h"
#include "planning/waypoint_rollout.h"

namespace cdiff::planners {
namespace {

constexpr double kTrainedPeriod = 0.1;  // between decisions [s]

}  // namespace

void UniadMiniOptions::describe(core::OptionsVisitor& visitor) {
  WeightOptions::describe(visitor);
  controller.describe(visitor);
  visitor.group({"adjustment", "", "How plans are moved away from occupied cells."}, adjustment);
  visitor.number({"frozen_image_time", "s", "The same image for so long while moving is a fault."},
                 frozen_image_time, 0.1, 60.0);
  visitor.number({"least_score", "", "Score of vehicles and lines that are shown."}, least_score,
                 0.0, 1.0);
  visitor.number({"no_throttle_above", "m/s",
                  "No throttle above this speed, as the published agent has it at 5; 0: never."},
                 no_throttle_above, 0.0, 100.0);
}

OccupiedPlaces occupiedPlaces(const BevGrid& bev, const PredictedOccupancy& occupancy,
                              double least) {
  OccupiedPlaces places;
  for (std::size_t step = 0; step < places.size(); ++step)
    places[step] = occupiedPlaces(bev, occupancy.probability(step), least);
  return places;
}

std::vector<planning::PerceivedOccupancy> perceivedOccupancy(const BevGrid& bev,
                                                             const PredictedOccupancy& occupancy,
                                                             const traffic::VehicleState& ego) {
  std::vector<planning::PerceivedOccupancy> perceived;
  for (std::size_t step = 0; step < occupancy.logits.size(); ++step) {
    planning::PerceivedOccupancy one;
    one.time = kEgoWaypointPeriod * static_cast<double>(step);
    one.frame = ego.pose();
    one.origin = bev.origin();
    one.cell = bev.cell;
    one.rows = static_cast<int>(bev.rows);
    one.columns = static_cast<int>(bev.columns);
    one.probability = occupancy.probability(step);
    perceived.push_back(std::move(one));
  }
  return perceived;
}

UniadMiniPlanner::UniadMiniPlanner(const UniadMiniOptions& options, const UniadMiniModel& model,
                                   const planning::PlannerParts& parts)
    : options_(options),
      architecture_(model.architecture),
      network_(model),
      roads_(parts.context.network),
      period_(parts.context.decision_period),
      simulation_step_(parts.context.simulation_step),
      rig_(model.architecture.ego.cameras()) {
  if (std::abs(period_ - kTrainedPeriod) > 1e-9) {
    throw core::InputError("key 'decision_period' is " + core::formatNumber(period_) +
                           " s; planner 'uniad_mini' was trained for 0.1 s and knows no other");
  }
  rendering::requireSameCameras(parts.rig, rig_.cameras, {"planner 'uniad_mini'", parts.rig_key});
  rig_.blind = parts.rig.blind;
}

UniadMiniPlanner::Memory UniadMiniPlanner::newMemory() const {
  return {WaypointController(options_.controller),
          BevMemory(period_),
          TrackMemory(period_),
          RigWatch(rig_, options_.frozen_image_time, simulation_step_),
          {}};
}

std::vector<planning::PlannedAction> UniadMiniPlanner::plan(
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
      memory.tracks.forget();
    }
  }
  memories_.forgetOthers();
  return actions;
}

UniadMiniInput UniadMiniPlanner::inputOf(const planning::PlanningTask& task,
                                         const NavigationNode& next, const Memory& memory) const {
  const traffic::VehicleState& state = task.vehicle->state;
  UniadMiniInput input;
  input.images = memory.watch.pixels(task);
  input.poses = memory.bevs.posesAt(state);
  input.past_tracks = memory.tracks.past();
  input.past = architecture_.ego.past_bev ? memory.bevs.past() : nullptr;
  input.motion = memory.bevs.motionAt(state, input.poses);
  input.command = next.command;
  return input;
}

void UniadMiniPlanner::drive(const planning::PlanningTask& task, Memory& memory,
                             planning::PlannedAction& planned) {
  const traffic::VehicleState& state = task.vehicle->state;
  const NavigationNode& next = memory.navigation.next(roads_, *task.route, state.position);
  const UniadMiniInput input = inputOf(task, next, memory);
  UniadMiniOutput output = network_.forward(input);
  if (!output.finite()) {
    memory.bevs.forget();
    memory.tracks.forget();
    planned = planning::failSafeAction(task, "a number of its plan is not finite");
    return;
  }
  const bool looks_back = architecture_.ego.past_bev;
  memory.bevs.keep(state, looks_back ? network_.bevAlone(input.motion) : network_.bev(),
                   architecture_.ego.width);
  memory.tracks.keep(std::move(output.tracks));
  conclude(task, output, next, memory, planned);
}

void UniadMiniPlanner::conclude(const planning::PlanningTask& task, const UniadMiniOutput& output,
                                const NavigationNode& next, Memory& memory,
                                planning::PlannedAction& planned) const {
  const traffic::VehicleState& state = task.vehicle->state;
  const BevGrid& bev = architecture_.ego.bev;
  const EgoWaypoints plan =
      adjustedPlan(output.plan, occupiedPlaces(bev, output.occupancy, options_.adjustment.occupied),
                   options_.adjustment);
  planned.action = memory.controller.track(state.speed, plan, state.pose().toBody(next.position));
  if (options_.no_throttle_above > 0.0 && state.speed > options_.no_throttle_above)
    planned.action.throttle = 0.0;
  planned.rollout =
      planning::rolloutAlong(state, {plan.begin(), plan.end()}, kEgoWaypointPeriod, planned.action);
  planned.perception = perceptionOf({output.agents, output.lines, {}}, state, options_.least_score);
  planned.perception.occupancy = perceivedOccupancy(bev, output.occupancy, state);
}

planning::PlannerDescriptor uniadMiniDescriptor() {
  planning::PlannerDescriptor descriptor = learnedDescriptor<UniadMiniOptions>(
      kUniadMini, {"cameras_command", "one pass of the network, then gradient steps"});
  descriptor.title = "UniAD mini";
  descriptor.help =
      "a compact UniAD: three cameras to a bird's-eye view, tracks, map, motion, occupancy and a "
      "plan.";
  descriptor.drives_cbv = false;
  descriptor.cameras = {"front", "front_left", "front_right"};
  descriptor.rig = rendering::kFrontThreeRig;
  descriptor.make = [](const planning::PlannerParts& parts) {
    const auto& options = parts.options.of<UniadMiniOptions>();
    return std::make_unique<UniadMiniPlanner>(options, readUniadMiniModel(options.folder()), parts);
  };
  return descriptor;
}

}  // namespace cdiff::planners
