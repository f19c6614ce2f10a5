// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "what_if/driver.h"

#include "core/option_fields.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::what_if {
namespace {

using core::InputError;
using planning::PlannedAction;
using planning::PlanningTask;

void requireEgoPlanner(const std::string& name) {
  if (name == planning::kExternalPlanner) {
    throw InputError("--ego external: a take-over runs in this process alone; give a planner (" +
                     core::joinText(planners::plannerNames(), ", ") + ", or one of a plug-in)");
  }
  const planning::PlannerDescriptor* descriptor = planners::findPlanner(name);
  if (descriptor != nullptr && descriptor->drives_ego) return;
  std::vector<std::string> known;
  for (const planning::PlannerDescriptor* planner : planners::registeredPlanners()) {
    if (planner->drives_ego) known.push_back(planner->name);
  }
  throw InputError(
      "--ego " + name + ": " + (descriptor == nullptr ? "an unknown planner" : "drives no ego") +
      "; expected one of {" + core::joinText(known, ", ") + "}" + core::didYouMean(name, known));
}

/// The options that differ from the session's are the driver's own.
void requireOwnKeys(const session::ScenarioOptions& before, const session::ScenarioOptions& after,
                    const std::string& planner) {
  const auto old_values = core::flatOptions(before);
  for (const auto& [key, value] : core::flatOptions(after)) {
    const auto old_value = old_values.find(key);
    const bool own = key.compare(0, planner.size() + 1, planner + ".") == 0;
    if (own || (old_value != old_values.end() && old_value->second == value)) continue;
    throw InputError("--set changes key '" + key +
                     "', which is the session's; expected options of the driver (" + planner +
                     ".KEY)");
  }
}

}  // namespace

std::string defaultDriver() { return planners::plannerTitled("Careful driver"); }

std::string DriverChoice::label() const {
  std::string text = planner;
  for (const std::string& assignment : set) {
    const bool named = assignment.compare(0, planner.size() + 1, planner + ".") == 0;
    text += " " + assignment.substr(named ? planner.size() + 1 : 0);
  }
  return text;
}

Driver::Driver(const session::SessionSetup& setup, const DriverChoice& choice)
    : setup_(setup), choice_(choice), options_(setup.options()) {
  requireEgoPlanner(choice.planner);
  for (const std::string& assignment : choice.set)
    core::overrideOption(assignment, "--set", options_);
  requireOwnKeys(setup.options(), options_, choice.planner);
  options_.ego_planner = choice.planner;
  options_.validate();
}

bool Driver::sees() const { return planners::seesImages(choice_.planner); }

std::unique_ptr<planning::Planner> Driver::make() const {
  return planners::makePlanner(
      choice_.planner,
      {setup_.planningContext(), options_.planner_options, options_.vehicle, options_.camera,
       options_.ego_guidance, "ego_guidance.", options_.ego_rig, "ego_rig"});
}

std::vector<PlannedAction> RecordedActions::plan(const traffic::TrafficSnapshot& snapshot,
                                                 const std::vector<PlanningTask>& tasks) {
  std::vector<PlannedAction> actions;
  for (const PlanningTask& task : tasks) {
    actions.push_back(planning::failSafeAction(task));
    const auto recorded = run_.actionAt(snapshot.tick, task.vehicle->id);
    if (recorded) actions.back().action = *recorded;
  }
  return actions;
}

std::vector<PlannedAction> TakenOverEgo::plan(const traffic::TrafficSnapshot& snapshot,
                                              const std::vector<PlanningTask>& tasks) {
  std::vector<PlannedAction> own = driver_->plan(snapshot, tasks);
  return snapshot.tick < take_over_tick_ ? recorded_.plan(snapshot, tasks) : own;
}

}  // namespace cdiff::what_if
