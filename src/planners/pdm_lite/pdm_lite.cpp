// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/pdm_lite.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "dynamics/action_rollout.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "planners/pdm_lite/forecasts.h"
#include "planners/pdm_lite/idm.h"
#include "planners/pdm_lite/lateral_controller.h"
#include "planners/pdm_lite/longitudinal_controller.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {
namespace {

constexpr double kStandingSpeed = 0.1;      // [m/s]
constexpr double kStuckTime = 8.5;          // published: 170 ticks at 20 Hz [s]
constexpr double kRollbackSpeed = 0.5;      // [m/s]
constexpr double kLaneChangeHorizon = 1.1;  // of boxes near a lane change [s]
constexpr double kEndZone = 5.0;            // of the route [m]
constexpr double kCreepSpeed = 1.0;         // in the end zone [m/s]
constexpr double kLeastBraking = 1.0;       // of an even style that waits [m/s^2]
constexpr double kHardestBraking = 8.0;     // of an even style [m/s^2]

/// Pedals in the last meters of the route.
PedalCommand endPedals(double remaining, double speed, double target_speed) {
  if (remaining > 0.0 && speed < kCreepSpeed) {
    return pedals(speed, std::min(kCreepSpeed, target_speed));
  }
  return {0.0, true};
}

/// Brake that stops the vehicle 1 m beyond the end of the route at an even deceleration.
double endBrake(double remaining, double speed, double full_deceleration) {
  constexpr double kOvershoot = 1.0;
  const double distance = remaining + kOvershoot;
  if (distance <= 0.0) return 1.0;
  return std::clamp(speed * speed / (2.0 * distance * full_deceleration), 0.0, 1.0);
}

/// Even deceleration that ends where the vehicle would be in the way [m/s^2].
double evenBraking(const traffic::VehicleState& now, const traffic::VehicleState& meeting) {
  constexpr double kMargin = 2.0;  // [m]
  constexpr double kShortest = 0.5;
  const double distance = (meeting.position - now.position).norm() - kMargin;
  return std::clamp(now.speed * now.speed / (2.0 * std::max(distance, kShortest)), kLeastBraking,
                    kHardestBraking);
}

/// How long the road ahead of a vehicle that yielded must be clear before it drives on [s].
double restartDelay(int slot) { return slot < 0 ? 0.0 : 0.5 + 0.2 * slot; }

void requireComplete(const planning::PlanningTask& task) {
  if (task.vehicle == nullptr) {
    throw std::invalid_argument("PdmLite: the task of slot " + std::to_string(task.slot) +
                                " has no vehicle");
  }
  if (task.route == nullptr || task.route->empty()) {
    throw std::invalid_argument("PdmLite: vehicle '" + task.vehicle->id + "' has no route");
  }
}

}  // namespace

PdmLite::PdmLite(const PdmLiteOptions& options, const dynamics::BicycleModelOptions& vehicle,
                 const planning::PlanningContext& context)
    : options_(options),
      model_(vehicle),
      network_(context.network),
      decision_period_(context.decision_period),
      drivers_(context.seed, "driver") {
  options_.validate();
}

PdmLite::Driver PdmLite::driverOf(const planning::PlanningTask& task) const {
  constexpr double kSlowest = 0.5;
  constexpr double kFastest = 1.5;
  Driver driver;
  if (task.slot < 0) return driver;
  const core::RandomKey key{core::hashText(task.vehicle->id), 0, 0};
  if (options_.cbv_speed_spread > 0.0) {
    const double factor = 1.0 + options_.cbv_speed_spread * drivers_.normal(key, 0);
    driver.speed_factor = std::clamp(factor, kSlowest, kFastest);
  }
  if (options_.cbv_headway_spread > 0.0)
    driver.headway = options_.cbv_headway_spread * std::abs(drivers_.normal(key, 1));
  return driver;
}

DrivingStyle PdmLite::styleOf(const planning::PlanningTask& task, const Driver& driver) const {
  DrivingStyle style = options_.styles ? options_.styles(task.vehicle->id) : DrivingStyle();
  if (task.slot >= 0 && !style.even()) {
    style.acceleration = options_.cbv_acceleration;
    style.deceleration = options_.cbv_deceleration;
  }
  style.time_headway += driver.headway;
  return style;
}

std::size_t PdmLite::forecastSteps(double horizon) const {
  const double shorter = std::min(horizon, options_.forecast_horizon);
  return static_cast<std::size_t>(std::max(1L, std::lround(shorter / planning::kForecastStep)));
}

std::vector<planning::PlannedAction> PdmLite::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  Forecasts forecasts(snapshot.vehicles.size());
  std::vector<planning::PlannedAction> actions;
  for (const planning::PlanningTask& task : tasks) {
    requireComplete(task);
    const Driver driver = driverOf(task);
    const traffic::VehicleState& state = task.vehicle->state;
    Memory& memory = memories_.keep(task.vehicle->id, [&] {
      return Memory{{planning::RouteFollower(), LateralController(options_)}};
    });
    memory.driver.follower.update(*task.route, state.position);
    const double s = memory.driver.follower.arcLength();
    const Situation situation{
        task,
        styleOf(task, driver),
        snapshot,
        s,
        driver.speed_factor *
            initialTargetSpeed(options_, *task.route, s, state.speed, task.target_speed),
        nearLaneChange(*task.route, s, state.speed)};
    actions.push_back(planOne(situation, memory, forecasts));
  }
  memories_.forgetOthers();
  return actions;
}

EgoHorizon PdmLite::egoHorizon() const {
  const long decisions = std::lround(planning::kForecastStep / decision_period_);
  return {forecastSteps(options_.forecast_horizon), static_cast<int>(std::max(1L, decisions))};
}

planning::PlannedAction PdmLite::planOne(const Situation& situation, Memory& memory,
                                         Forecasts& forecasts) const {
  const planning::PlanningTask& task = situation.task;
  const traffic::VehicleState& state = task.vehicle->state;
  planning::PlannedAction planned{task.slot, task.vehicle->id, {}, {}};
  planned.rollout =
      forecastEgo(state, *task.route, memory.driver, situation.initial_speed, model_, egoHorizon());
  const double target = targetSpeed(situation, planned.rollout, memory, forecasts);
  planned.action = pedalAction(situation, target, memory);
  planned.action.steer = steerAlong(*task.route, state, memory.driver);
  return planned;
}

traffic::ControlAction PdmLite::pedalAction(const Situation& situation, double target,
                                            Memory& memory) const {
  const double speed = situation.task.vehicle->state.speed;
  const double remaining = situation.task.route->length() - situation.arc_length;
  if (situation.style.even()) return evenAction(situation, remaining, target);
  const PedalCommand pedal =
      remaining < kEndZone ? endPedals(remaining, speed, target) : pedals(speed, target);
  memory.standing_time = speed < kStandingSpeed ? memory.standing_time + decision_period_ : 0.0;
  const bool stuck = memory.standing_time >= kStuckTime - 1e-9 && remaining > 0.0;
  if (stuck) return {1.0, 0.0, 0.0};
  if (!pedal.brake) return {pedal.throttle, 0.0, 0.0};
  const bool ends = remaining < kEndZone && target > 0.0 && speed >= kRollbackSpeed;
  const double strongest = model_.options().max_deceleration;
  return {0.0, 0.0, ends ? endBrake(remaining, speed, strongest) : 1.0};
}

traffic::ControlAction PdmLite::evenAction(const Situation& situation, double remaining,
                                           double target) const {
  const double speed = situation.task.vehicle->state.speed;
  const bool creeps = remaining > 0.0 && speed < kCreepSpeed;
  const bool ends = remaining < kEndZone;
  if (ends && creeps) target = std::min(target, kCreepSpeed);
  const double wanted = (target - speed) / IdmParameters().time_bound;
  const double acceleration = std::clamp(wanted, -kHardestBraking, situation.style.acceleration);
  const double next = std::max(0.0, speed + acceleration * traffic::kRolloutStep);
  traffic::ControlAction action = dynamics::inferAction(model_, {speed, next, 0.0});
  if (!ends || creeps) return action;
  action.throttle = 0.0;
  action.brake =
      std::max(action.brake, endBrake(remaining, speed, model_.options().max_deceleration));
  return action;
}

double PdmLite::targetSpeed(const Situation& situation,
                            const std::vector<planning::RolloutPoint>& rollout, Memory& memory,
                            Forecasts& forecasts) const {
  const planning::PlanningTask& task = situation.task;
  const Obstruction others = obstructionOf(situation, rollout, forecasts);
  const double target = std::min(others.target, speedBeforeLines(situation, memory));
  if (!mustWait(situation, others.met.has_value(), memory)) {
    memory.waiting = 0.0;
    return target;
  }
  if (!situation.style.even()) return 0.0;
  const traffic::VehicleState& now = task.vehicle->state;
  if (others.met)
    memory.waiting = std::max(memory.waiting, evenBraking(now, rollout[*others.met].state));
  return std::min(target, now.speed - memory.waiting * IdmParameters().time_bound);
}

double PdmLite::speedBeforeLines(const Situation& situation, Memory& memory) const {
  const map::Route& route = *situation.task.route;
  const double speed = situation.task.vehicle->state.speed;
  const double s = situation.arc_length;
  const auto before = [&](const StopLine& line) {
    return idmBefore(line, situation.style, speed, situation.initial_speed);
  };
  double slowest = std::numeric_limits<double>::infinity();
  if (options_.obey_lights) {
    const auto light = distanceToRedLight(route, s, situation.snapshot);
    if (light) slowest = before(lineOfLight(*light));
  }
  if (options_.obey_stop_signs) {
    const auto sign = memory.stop_signs.distance(route, s, speed);
    if (sign) slowest = std::min(slowest, before(lineOfStopSign(*sign)));
  }
  return slowest;
}

PdmLite::Obstruction PdmLite::obstructionOf(const Situation& situation,
                                            const std::vector<planning::RolloutPoint>& rollout,
                                            Forecasts& forecasts) const {
  const traffic::Vehicle& self = *situation.task.vehicle;
  const map::Route& route = *situation.task.route;
  const std::vector<geometry::OrientedBox> own = egoBoxes(self, rollout);
  const double reach =
      std::max(options_.detection_radius, leaderReach(route, situation.arc_length, self.state));
  const bool exempt = !situation.near_lane_change;
  const bool first_counts = situation.style.even();
  Obstruction found{freeSpeed(situation.style, self.state.speed, situation.initial_speed), {}};
  for (std::size_t i = 0; i < situation.snapshot.vehicles.size(); ++i) {
    const traffic::Vehicle& other = situation.snapshot.vehicles[i];
    const double distance = (other.state.position - self.state.position).norm();
    if (distance > reach || other.id == self.id || traffic::onDifferentLevels(self, other))
      continue;
    if (exempt && isLeading(route, situation.arc_length, other.state)) {
      const double behind = idmBehind(situation.style, self, other, situation.initial_speed);
      found.target = std::min(found.target, behind);
      continue;
    }
    if (exempt && isTrailing(route, situation.arc_length, other.state)) continue;
    if (distance > options_.detection_radius || (found.met && !first_counts)) continue;
    const auto step = meetsBox(situation, other, own, forecastOf(situation.snapshot, i, forecasts));
    if (step && isBicycle(other.dimensions)) {
      const double behind = idmBehind(situation.style, self, other, situation.initial_speed);
      found.target = std::min(found.target, behind);
    } else if (step && (!found.met || *step < *found.met)) {
      found.met = step;
    }
  }
  return found;
}

std::optional<std::size_t> PdmLite::meetsBox(
    const Situation& situation, const traffic::Vehicle& other,
    const std::vector<geometry::OrientedBox>& own,
    const std::vector<traffic::VehicleState>& forecast) const {
  const bool lane_change = situation.near_lane_change;
  const double horizon = lane_change ? kLaneChangeHorizon : options_.forecast_horizon;
  const std::size_t steps = forecastSteps(horizon);
  return meet(own, otherBoxes(other.dimensions, forecast, steps, lane_change), steps);
}

bool PdmLite::mustWait(const Situation& situation, bool box_met, Memory& memory) const {
  memory.clear_time = box_met ? 0.0 : memory.clear_time + decision_period_;
  if (box_met) {
    memory.gave_way = true;
    return true;
  }
  const bool delayed =
      memory.gave_way && memory.clear_time < restartDelay(situation.task.slot) - 1e-9;
  if (!delayed) memory.gave_way = false;
  return delayed;
}

const std::vector<traffic::VehicleState>& PdmLite::forecastOf(
    const traffic::TrafficSnapshot& snapshot, std::size_t index, Forecasts& forecasts) const {
  auto& forecast = forecasts[index];
  if (!forecast) {
    forecast = planning::forecastMotion(snapshot.vehicles[index], network_, model_.options(),
                                        forecastSteps(options_.forecast_horizon));
  }
  return *forecast;
}

}  // namespace cdiff::planners
