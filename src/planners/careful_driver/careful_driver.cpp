// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/careful_driver/careful_driver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "dynamics/action_rollout.h"
#include "e2e_cdiff/core/random.h"
#include "planners/pdm_lite/idm.h"
#include "planning/surrounding_vehicles.h"
#include "reference_driver/fuzzy_driver.h"
#include "reference_driver/rss_driver.h"

namespace cdiff::planners {
namespace {

using reference_driver::OwnMotion;
using reference_driver::SeenVehicle;

constexpr double kSight = 80.0;  // [m]
constexpr double kNever = std::numeric_limits<double>::infinity();

std::unique_ptr<reference_driver::ReferenceDriver> makeDriver(
    const CarefulDriverPlannerOptions& options) {
  if (options.driver == "rss") return std::make_unique<reference_driver::RssDriver>();
  if (options.driver == "fuzzy") return std::make_unique<reference_driver::FuzzyDriver>();
  return std::make_unique<reference_driver::CarefulDriver>(options);
}

/// Speed from which it stands 1 m beyond the end of its route, braking comfortably.
double speedBeforeEnd(double remaining) {
  constexpr double kComfortable = 2.0;  // [m/s^2]
  constexpr double kOvershoot = 1.0;    // [m]
  return remaining <= 0.0 ? 0.0 : std::sqrt(2.0 * kComfortable * (remaining + kOvershoot));
}

}  // namespace

void CarefulDriverPlannerOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"driver", "",
                "Who reacts: C of UN R157 (all its keys are here), R of responsibility-sensitive "
                "safety, or the fuzzy safety model."},
               driver, {"careful", "rss", "fuzzy"});
  CarefulDriverOptions::describe(visitor);
  visitor.number({"top_speed", "m/s", "It drives no faster."}, top_speed, 1.0, 60.0);
  visitor.number({"acceleration", "m/s^2", "Of the undisturbed driver."}, acceleration, 0.1, 5.0);
  visitor.number({"following_deceleration", "m/s^2",
                  "Of the undisturbed driver, behind a lead and before a stop line."},
                 following_deceleration, 0.1, 8.0);
}

CarefulDriverPlanner::CarefulDriverPlanner(const CarefulDriverPlannerOptions& options,
                                           const dynamics::BicycleModelOptions& vehicle,
                                           double decision_period)
    : options_(options), model_(vehicle), decision_period_(decision_period) {
  options_.validate();
}

CarefulDriverPlanner::Memory CarefulDriverPlanner::makeMemory() const {
  Memory memory;
  memory.reference = makeDriver(options_);
  return memory;
}

std::string CarefulDriverPlanner::faultOf(const traffic::TrafficSnapshot& snapshot,
                                          const planning::PlanningTask& task) const {
  const std::string fault = planning::faultOf(snapshot, task);
  const double speed = task.vehicle->state.speed;
  if (!fault.empty() || options_.stopsFrom(speed)) return fault;
  return "from its " + core::formatNumber(speed) + " m/s it stops in " +
         core::formatNumber(options_.stoppingTime(speed)) + " s, which is beyond its horizon of " +
         core::formatNumber(options_.horizon) + " s (key careful_driver.horizon)";
}

std::vector<planning::PlannedAction> CarefulDriverPlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions;
  for (const planning::PlanningTask& task : tasks) {
    const std::string fault = faultOf(snapshot, task);
    actions.push_back(planning::failSafeAction(task, fault));
    if (!fault.empty()) continue;
    Memory& memory = memories_.keep(task.vehicle->id, [&] { return makeMemory(); });
    actions.back().action = actionOf(snapshot, task, memory);
  }
  memories_.forgetOthers();
  return actions;
}

traffic::ControlAction CarefulDriverPlanner::actionOf(const traffic::TrafficSnapshot& snapshot,
                                                      const planning::PlanningTask& task,
                                                      Memory& memory) const {
  const traffic::VehicleState& state = task.vehicle->state;
  const double steer = steerAlong(*task.route, state, memory.driver);
  const View view = look(snapshot, task, memory);
  const double braking = memory.reference->brake(view.own, view.seen, decision_period_);
  const double acceleration = undisturbed(snapshot, task, view, memory);
  const double applied = braking > 0.0 ? std::min(acceleration, -braking) : acceleration;
  const double next = std::max(0.0, state.speed + applied * traffic::kRolloutStep);
  traffic::ControlAction action = dynamics::inferAction(model_, {state.speed, next, 0.0});
  if (next <= 0.0) action = {0.0, 0.0, 1.0};
  action.steer = steer;
  return action;
}

CarefulDriverPlanner::View CarefulDriverPlanner::look(const traffic::TrafficSnapshot& snapshot,
                                                      const planning::PlanningTask& task,
                                                      Memory& memory) const {
  const traffic::Vehicle& self = *task.vehicle;
  const double arc_length = memory.driver.follower.arcLength();
  const reference_driver::DrivenPath path(task.route->path(), arc_length, kSight);
  const double offset = path.poseAt(arc_length).toBody(self.state.position).y();
  View view;
  view.own = {snapshot.time,    arc_length,        offset,
              self.state.speed, self.acceleration, self.dimensions};
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    const bool near = (other.state.position - self.state.position).norm() < kSight;
    if (other.id == self.id || !near || traffic::onDifferentLevels(self, other)) continue;
    std::optional<std::size_t> hint;
    auto seen = path.see(other.state, other.dimensions, hint);
    if (!seen) continue;
    seen->id = core::hashText(other.id);
    seen->acceleration = other.acceleration;
    noteLead(other, *seen, view, memory);
    view.seen.push_back(*seen);
  }
  return view;
}

void CarefulDriverPlanner::noteLead(const traffic::Vehicle& vehicle, const SeenVehicle& seen,
                                    View& view, Memory& memory) const {
  const auto conflict = reference_driver::conflictOf(view.own, view.own.speed, seen);
  constexpr double kMargin = 0.25;  // beside its box [m]
  const bool in_way = conflict.to_corridor < kMargin;
  const auto known = memory.in_way_since.find(vehicle.id);
  if (known == memory.in_way_since.end()) {
    memory.in_way_since[vehicle.id] = in_way ? -kNever : kNever;
  } else if (!in_way) {
    known->second = kNever;
  } else if (known->second == kNever) {
    known->second = view.own.time;
  }
  const double since = memory.in_way_since[vehicle.id];
  constexpr double kStarting = 1.0;  // [m/s]: it looks before it starts
  const bool counts = view.own.speed < kStarting ||
                      view.own.time - since >= options_.evaluation_time + options_.delay;
  if (!in_way || !counts || !conflict.ahead) return;
  if (view.lead && view.lead->gap <= conflict.gap) return;
  view.lead = Lead{conflict.gap, std::max(0.0, seen.along_speed)};
}

double CarefulDriverPlanner::undisturbed(const traffic::TrafficSnapshot& snapshot,
                                         const planning::PlanningTask& task, const View& view,
                                         Memory& memory) const {
  PdmLiteOptions rules;
  rules.speed_limit_share = 1.0;
  DrivingStyle style;
  style.acceleration = options_.acceleration;
  style.deceleration = std::min(3.0, options_.following_deceleration);
  const map::Route& route = *task.route;
  const double s = view.own.arc_length;
  const double speed = view.own.speed;
  const double desired = std::min({initialTargetSpeed(rules, route, s, speed, task.target_speed),
                                   options_.top_speed, speedBeforeEnd(route.length() - s)});
  double next = freeSpeed(style, speed, desired);
  if (view.lead) {
    IdmObstacle lead;
    lead.distance = view.lead->gap;
    lead.speed = view.lead->speed;
    lead.minimum_gap = reference_driver::followingGap(speed);
    lead.time_headway = 0.0;
    next = std::min(next, idmBehind(style, lead, speed, desired));
  }
  if (const auto light = distanceToRedLight(route, s, snapshot))
    next = std::min(next, idmBefore(lineOfLight(*light), style, speed, desired));
  if (const auto sign = memory.stop_signs.distance(route, s, speed))
    next = std::min(next, idmBefore(lineOfStopSign(*sign), style, speed, desired));
  const double hardest = std::min(options_.following_deceleration, options_.deceleration);
  return std::clamp((next - speed) / IdmParameters().time_bound, -hardest, options_.acceleration);
}

planning::PlannerDescriptor carefulDriverDescriptor() {
  planning::PlannerDescriptor descriptor;
  descriptor.name = "careful_driver";
  descriptor.title = "Careful driver";
  descriptor.help = "drives by the rules and reacts as late as the careful driver of UN R157.";
  descriptor.options = planning::makePlannerOptions<CarefulDriverPlannerOptions>;
  descriptor.make = [](const planning::PlannerParts& parts) {
    return std::make_unique<CarefulDriverPlanner>(parts.options.of<CarefulDriverPlannerOptions>(),
                                                  parts.vehicle, parts.context.decision_period);
  };
  return descriptor;
}

}  // namespace cdiff::planners
