// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/collection_loop.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "collection/camera_sight.h"
#include "collection/traffic_driver.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"

namespace cdiff::collection {
namespace {

// Elements of a burst's draws.
constexpr std::uint32_t kInterval = 0;
constexpr std::uint32_t kDuration = 1;
constexpr std::uint32_t kSteer = 2;
constexpr std::uint32_t kPedal = 3;
constexpr std::uint32_t kSteerSign = 4;
constexpr std::uint32_t kStall = 5;

// Elements of a period's draws.
constexpr std::uint32_t kPhase = 6;
constexpr std::uint32_t kChance = 7;
constexpr double kShortestSpell = 0.25;  // of the longest

constexpr double kSlow = 1.0;           // [m/s] slower vehicles get no noise
constexpr double kSmallest = 0.3;       // of the largest steering noise
constexpr double kStallBrake = 0.5;     // so that who follows can stop, too
constexpr double kLeastThrottle = 0.3;  // less does nothing (BicycleModel)

std::uint64_t seedOf(const session::SessionSetup& setup) {
  return static_cast<std::uint64_t>(setup.options().seed);
}

using MakePlanner = std::function<std::unique_ptr<planning::Planner>()>;

std::unique_ptr<PerturbedPlanner> perturbedPlanner(const session::SessionSetup& setup,
                                                   const CollectionOptions& options,
                                                   const MakePlanner& make, Policy policy,
                                                   const std::string& name) {
  if (planners::seesImages(name))
    throw core::InputError(
        "planner '" + name +
        "' needs images; data are collected with planners that do not, such as '" +
        std::string(planners::kDefaultEgoPlanner) + "'");
  std::unique_ptr<planning::Planner> planner = make();
  if (options.sight == "camera")
    planner = std::make_unique<SightedPlanner>(make, setup.options().camera, setup.network());
  return std::make_unique<PerturbedPlanner>(std::move(planner), options, seedOf(setup),
                                            setup.options().decision_period, std::move(policy));
}

/// Empty where none is asked for.
Policy policyOf(const session::SessionSetup& setup, const CollectionOptions& options) {
  if (options.policy.empty()) return {};
  Policy policy{setup.makeCbvPlanner(options.policy), nullptr};
  if (!planners::seesImages(options.policy)) return policy;
  session::ScenarioOptions driven_by_it = setup.options();
  driven_by_it.cbv_planner = options.policy;
  policy.cameras =
      std::make_unique<session::VehicleCameras>(setup, session::VehicleRigs(driven_by_it));
  return policy;
}

std::unique_ptr<session::World> disturbedWorld(const session::SessionSetup& setup,
                                               const NoiseOptions& noise) {
  auto world = std::make_unique<session::World>(setup);
  world->setTakeOverDisturbance([noise, seed = seedOf(setup), &snapshot = world->snapshot()](
                                    const std::string& id, const traffic::VehicleState& state) {
    return disturbedStart(noise, seed, snapshot.tick, id, state);
  });
  return world;
}

}  // namespace

PerturbedPlanner::PerturbedPlanner(std::unique_ptr<planning::Planner> planner,
                                   const CollectionOptions& options, std::uint64_t seed,
                                   double decision_period, Policy policy)
    : planner_(std::move(planner)),
      policy_(std::move(policy)),
      options_(options),
      seed_(seed),
      noise_(seed, "collection_noise"),
      spells_(seed, "collection_policy"),
      decision_period_(decision_period) {}

/// Time is cut into periods, by vehicle; the policy drives at the start of some of them.
bool PerturbedPlanner::policyDrives(const std::string& vehicle_id, double time) const {
  if (!policy_.planner) return false;
  const std::uint64_t vehicle = core::hashText(vehicle_id);
  const double phase = spells_.uniform({vehicle, 0, 0}, kPhase);
  const double place = time / options_.policy_period + phase;
  const core::RandomKey key{vehicle, static_cast<std::uint32_t>(place), 0};
  if (spells_.uniform(key, kChance) >= options_.policy_share) return false;
  const double longest = options_.policy_time;
  const double duration = spells_.uniform(key, kDuration, kShortestSpell * longest, longest);
  return (place - std::floor(place)) * options_.policy_period < duration;
}

void PerturbedPlanner::takePolicy(const traffic::TrafficSnapshot& snapshot,
                                  const std::vector<planning::PlanningTask>& asked,
                                  std::vector<planning::PlannedAction>& actions) {
  std::vector<planning::PlanningTask> tasks;
  for (const planning::PlanningTask& task : asked) {
    if (policyDrives(task.vehicle->id, snapshot.time)) tasks.push_back(task);
  }
  if (!policy_.planner) return;
  std::vector<session::SlotImage> images;
  if (policy_.cameras) {
    for (const planning::PlanningTask& task : tasks)
      policy_.cameras->render(snapshot, *task.vehicle, task.slot, images);
    session::attachImages(images, policy_.cameras->rigs(), tasks);
  }
  for (planning::PlannedAction& action : policy_.planner->plan(snapshot, tasks)) {
    perturbed_.insert(action.vehicle_id);
    for (planning::PlannedAction& own : actions) {
      if (own.vehicle_id == action.vehicle_id) std::swap(own, action);
    }
  }
}

PerturbedPlanner::Burst PerturbedPlanner::drawn(const std::string& vehicle, std::uint32_t count,
                                                double after) const {
  const core::RandomKey key{core::hashText(vehicle), count, 0};
  const NoiseOptions& noise = options_.noise;
  Burst burst;
  burst.count = count;
  burst.begin = after - noise.interval * std::log(1.0 - noise_.uniform(key, kInterval));
  burst.stall = noise_.uniform(key, kStall) < noise.stall_share;
  burst.end =
      burst.begin +
      (burst.stall
           ? noise_.uniform(key, kDuration, noise.stall_minimum_time, noise.stall_maximum_time)
           : noise_.uniform(key, kDuration, noise.minimum_time, noise.maximum_time));
  const double size = noise_.uniform(key, kSteer, kSmallest, 1.0);
  burst.steer = noise_.uniform(key, kSteerSign) < 0.5 ? -size : size;
  burst.pedal = noise_.uniform(key, kPedal, -1.0, 1.0);
  return burst;
}

/// Noise is for vehicles that move; a stop that starts while one moves lasts to its end, any other
/// is left out.
bool PerturbedPlanner::acts(double time, double speed, Burst& burst) const {
  if (time < burst.begin || time >= burst.end) return false;
  const bool moves = speed > kSlow;
  if (!burst.begun && !moves && burst.stall) {
    burst.end = time;
    return false;
  }
  burst.begun = true;
  return moves || burst.stall;
}

void PerturbedPlanner::disturb(const Burst& burst, double speed,
                               traffic::ControlAction& action) const {
  if (burst.stall) {
    action = {0.0, action.steer, std::max(action.brake, kStallBrake)};
    return;
  }
  const NoiseOptions& noise = options_.noise;
  const double largest = noise.steer * std::min(1.0, noise.steer_speed / speed);
  action.steer = std::clamp(action.steer + burst.steer * largest, -1.0, 1.0);
  const double pedal = burst.pedal * noise.pedal;
  if (pedal < 0.0) {
    action.throttle = 0.0;
    action.brake = std::clamp(action.brake - pedal, 0.0, 1.0);
  } else if (action.brake == 0.0) {
    action.throttle = std::clamp(std::max(action.throttle, kLeastThrottle) + pedal, 0.0, 1.0);
  }
}

std::vector<planning::PlannedAction> PerturbedPlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlanningTask> asked = tasks;
  for (planning::PlanningTask& task : asked)
    task.target_speed = driverOf(task.vehicle->id).target_speed;
  std::vector<planning::PlannedAction> actions = planner_->plan(snapshot, asked);
  if (snapshot.time > last_time_ + 1.5 * decision_period_) bursts_.clear();
  last_time_ = snapshot.time;
  std::map<std::string, Burst> kept;
  perturbed_.clear();
  for (std::size_t i = 0; i < std::min(actions.size(), tasks.size()); ++i) {
    const std::string& id = tasks[i].vehicle->id;
    const auto known = bursts_.find(id);
    Burst burst = known != bursts_.end() ? known->second : drawn(id, 0, snapshot.time);
    if (snapshot.time >= burst.end) burst = drawn(id, burst.count + 1, burst.end);
    const double speed = tasks[i].vehicle->state.speed;
    if (acts(snapshot.time, speed, burst)) {
      disturb(burst, speed, actions[i].action);
      perturbed_.insert(id);
    }
    kept.emplace(id, burst);
  }
  bursts_ = std::move(kept);
  takePolicy(snapshot, asked, actions);
  return actions;
}

traffic::VehicleState disturbedStart(const NoiseOptions& options, std::uint64_t seed,
                                     std::uint64_t tick, const std::string& vehicle,
                                     const traffic::VehicleState& state) {
  const core::RandomStream random(seed, "collection_start");
  const core::RandomKey key{core::hashText(vehicle), static_cast<std::uint32_t>(tick), 0};
  constexpr double kMost = 2.0;  // standard deviations
  const auto draw = [&](std::uint32_t element) {
    return std::clamp(random.normal(key, element), -kMost, kMost);
  };
  traffic::VehicleState result = state;
  result.position +=
      options.lateral * draw(0) * geometry::leftNormal(geometry::direction(state.heading));
  result.heading += core::degreesToRadians(options.heading) * draw(1);
  return result;
}

ImageSchedule::ImageSchedule(std::int64_t period) : period_(std::max<std::int64_t>(1, period)) {}

bool ImageSchedule::due(const traffic::Vehicle& vehicle, int slot, std::int64_t decision,
                        bool noisy) {
  const bool taken_over = !vehicle.applied_action;
  if (noisy || taken_over) disturbed_[vehicle.id] = decision;
  if (taken_over) return false;
  const auto disturbed = disturbed_.find(vehicle.id);
  const std::int64_t since = disturbed == disturbed_.end() ? 0 : decision - disturbed->second;
  return since == 1 || since == 4 || (decision + slot + 1) % period_ == 0;
}

CollectionLoop::CollectionLoop(const session::SessionSetup& setup, const CollectionOptions& options,
                               bool images)
    : schedule_(std::llround(options.image_period / setup.options().decision_period)),
      loop_(setup, makeParts(setup, options, images)) {}

session::LoopParts CollectionLoop::makeParts(const session::SessionSetup& setup,
                                             const CollectionOptions& options, bool images) {
  auto ego = perturbedPlanner(
      setup, options, [&setup] { return setup.makeEgoPlanner(); }, {}, setup.options().ego_planner);
  auto cbv = perturbedPlanner(
      setup, options, [&setup] { return setup.makeCbvPlanner(); }, policyOf(setup, options),
      setup.options().cbv_planner);
  ego_planner_ = ego.get();
  cbv_planner_ = cbv.get();
  session::LoopParts parts;
  parts.ego_planner = {std::move(ego)};
  parts.cbv_planner = {std::move(cbv)};
  parts.selector =
      std::make_unique<TrafficDriver>(options, setup.graph(), setup.drivableArea(), seedOf(setup));
  if (images) {
    parts.cameras.emplace(setup, session::VehicleRigs::front(setup.options().camera));
    parts.image_wish = [this, &setup](const traffic::TrafficSnapshot& snapshot,
                                      const traffic::Vehicle& vehicle, int slot) {
      const auto decision = static_cast<std::int64_t>(snapshot.tick / setup.ticksPerDecision());
      return schedule_.due(vehicle, slot, decision, perturbed(vehicle.id));
    };
  }
  parts.world = disturbedWorld(setup, options.noise);
  return parts;
}

bool CollectionLoop::perturbed(const std::string& vehicle_id) const {
  return ego_planner_->perturbed().count(vehicle_id) != 0 ||
         cbv_planner_->perturbed().count(vehicle_id) != 0;
}

}  // namespace cdiff::collection
