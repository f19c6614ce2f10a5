// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/ppo.h"

#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {
void PpoOptions::describe(core::OptionsVisitor& visitor) {
  WeightOptions::describe(visitor);
  visitor.text(
      {"after_goal", "",
       "Once a CBV has reached its goal: PDM-Lite along its route, or on toward the goal."},
      after_goal, {"route", "goal"});
}

Ppo::Ppo(const PpoOptions& options, const PdmLiteOptions& on_route,
         const dynamics::BicycleModelOptions& vehicle, const planning::PlanningContext& context)
    : options_(options),
      actor_(PpoActor::readWeights(options.folder())),
      on_route_(on_route, vehicle, context),
      ego_route_(context.ego_route),
      simulation_step_(context.simulation_step) {}

std::string Ppo::faultOf(const traffic::Vehicle* ego) const {
  if (ego_route_ == nullptr || ego_route_->empty()) return "the ego's route is not known";
  if (ego == nullptr) return "there is no ego";
  if (!planning::isFinite(ego->state)) return "the ego's state is not finite";
  return "";
}

std::vector<planning::PlannedAction> Ppo::plan(const traffic::TrafficSnapshot& snapshot,
                                               const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions;
  const std::string fault = faultOf(snapshot.ego());
  if (!fault.empty()) {
    for (const planning::PlanningTask& task : tasks)
      actions.push_back(planning::failSafeAction(task, fault));
    return actions;
  }
  forgetOthers(tasks);
  ego_.update(*ego_route_, snapshot, simulation_step_);
  const PpoGoal goal = ppoGoal(*ego_route_, ego_.arcLength());
  for (const planning::PlanningTask& task : tasks)
    actions.push_back(towardGoal(snapshot, task, goal));
  if (options_.after_goal == "route") driveOn(snapshot, tasks, actions);
  return actions;
}

planning::PlannedAction Ppo::towardGoal(const traffic::TrafficSnapshot& snapshot,
                                        const planning::PlanningTask& task, const PpoGoal& goal) {
  const PpoObservation observation = ppoObservation(snapshot, *snapshot.ego(), *task.vehicle, goal);
  const std::string unusable = ppoNotFinite(observation);
  if (!unusable.empty())
    return planning::failSafeAction(task, "the " + unusable + " is not finite");
  if (ppoGoalDistance(goal, task.vehicle->state) < kPpoGoalRadius)
    arrived_.insert(task.vehicle->id);
  return {task.slot, task.vehicle->id, ppoCommand(actor_.act(observation)), {}};
}

/// A vehicle that was released and is selected again gets a new goal.
void Ppo::forgetOthers(const std::vector<planning::PlanningTask>& tasks) {
  std::set<std::string> kept;
  for (const planning::PlanningTask& task : tasks) {
    if (arrived_.count(task.vehicle->id) != 0) kept.insert(task.vehicle->id);
  }
  arrived_ = std::move(kept);
}

void Ppo::driveOn(const traffic::TrafficSnapshot& snapshot,
                  const std::vector<planning::PlanningTask>& tasks,
                  std::vector<planning::PlannedAction>& actions) {
  std::vector<planning::PlanningTask> arrived;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const bool has_route = tasks[i].route != nullptr && !tasks[i].route->empty();
    if (arrived_.count(tasks[i].vehicle->id) != 0 && actions[i].fault.empty() && has_route)
      arrived.push_back(tasks[i]);
  }
  for (planning::PlannedAction& driven : on_route_.plan(snapshot, arrived)) {
    for (planning::PlannedAction& action : actions) {
      if (action.vehicle_id != driven.vehicle_id) continue;
      action = std::move(driven);
      break;
    }
  }
}

planning::PlannerDescriptor ppoDescriptor() {
  planning::PlannerDescriptor descriptor =
      learnedDescriptor<PpoOptions>(kPpo, {"cbv_ego_nearest_goal", "tanh of the mean", false});
  descriptor.title = "PPO";
  descriptor.help = "a small network, trained by PPO to reach a point just ahead of the ego.";
  descriptor.drives_ego = false;
  descriptor.make = [](const planning::PlannerParts& parts) {
    return std::make_unique<Ppo>(parts.options.of<PpoOptions>(), parts.options.of<PdmLiteOptions>(),
                                 parts.vehicle, parts.context);
  };
  return descriptor;
}

}  // namespace cdiff::planners
