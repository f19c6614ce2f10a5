// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/collection_loop.h"

#include <algorithm>
#include <cmath>

#include "collection/random_route.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/closed_loop.h"

namespace cdiff::collection {
namespace {

using planning::PlannedAction;
using traffic::SessionStatus;

// Elements of a session's draws.
constexpr std::uint32_t kLights = 0;
constexpr std::uint32_t kDensity = 1;

constexpr double kEgoBlockedTime = 60.0;    // [s]
constexpr double kEgoDeviation = 100.0;     // [m]
constexpr double kCollectionWarmUp = 20.0;  // [s]

}  // namespace

session::ScenarioOptions collectionScenario(session::ScenarioOptions scenario,
                                            const CollectionOptions& options) {
  options.validate();
  const core::RandomStream random(static_cast<std::uint64_t>(scenario.seed), "collection_session");
  const core::RandomKey key{core::hashText(scenario.name), 0, 0};
  scenario.max_cbv = options.vehicles;
  for (std::string* planner : {&scenario.ego_planner, &scenario.cbv_planner}) {
    if (planners::seesImages(*planner)) *planner = "pdm_lite";
  }
  scenario.protocol.time_limit = options.duration;
  scenario.protocol.time_limit_speed_percent = 0.0;
  scenario.protocol.blocked_time = kEgoBlockedTime;
  scenario.protocol.deviation_distance = kEgoDeviation;
  scenario.protocol.deviation_percent = 100.0;
  const bool own_lights = random.uniform(key, kLights) < options.program_lights_share;
  scenario.lights = own_lights ? "program" : "green";
  const bool file = scenario.demand != "generated" && scenario.demand != "none";
  if (file && scenario.seed % 2 != 0) scenario.demand = "generated";
  const double density =
      random.uniform(key, kDensity, options.minimum_density, options.maximum_density);
  scenario.traffic.density = std::llround(density);
  scenario.traffic.warm_up = std::min(scenario.traffic.warm_up, kCollectionWarmUp);
  return scenario;
}

std::unique_ptr<session::SessionSetup> collectionSetup(const session::ScenarioOptions& scenario,
                                                       const CollectionOptions& options) {
  auto setup = std::make_unique<session::SessionSetup>(scenario);
  const core::RandomStream random(static_cast<std::uint64_t>(scenario.seed), "collection_ego");
  const double length = options.duration * options.maximum_speed;
  const map::Route longer = extendedAtRandom(setup->graph(), setup->egoRoute(), length, random);
  if (longer.length() <= setup->egoRoute().length()) return setup;
  return std::make_unique<session::SessionSetup>(scenario, setup->import(), longer.path().points());
}

struct CollectionLoop::Decision {
  cbv::CbvSelection selection;
  std::vector<PlannedAction> actions;
  std::vector<session::SlotImage> images;
  std::vector<session::PlannerLatency> latencies;
};

CollectionLoop::CollectionLoop(const session::SessionSetup& setup, const CollectionOptions& options,
                               bool images)
    : setup_(setup),
      options_(options),
      seed_(static_cast<std::uint64_t>(setup.options().seed)),
      driver_(options, setup.graph(), setup.drivableArea(), seed_) {
  ego_planner_ = perturbedPlanner(setup.makeEgoPlanner(), setup.options().ego_planner);
  cbv_planner_ = perturbedPlanner(setup.makeCbvPlanner(), setup.options().cbv_planner);
  if (images) camera_.emplace(setup.options().camera, setup.network());
  world_ = std::make_unique<session::World>(setup);
  world_->setTakeOverDisturbance([this](const std::string& id, const traffic::VehicleState& state) {
    return disturbedStart(options_.noise, seed_, world_->snapshot().tick, id, state);
  });
}

CollectionLoop::~CollectionLoop() = default;

std::unique_ptr<PerturbedPlanner> CollectionLoop::perturbedPlanner(
    std::unique_ptr<planning::Planner> planner, const std::string& name) const {
  if (planner->needsImages())
    throw core::InputError("planner '" + name +
                           "' needs images; data are collected with planners "
                           "that do not, such as 'pdm_lite'");
  return std::make_unique<PerturbedPlanner>(std::move(planner), options_, seed_);
}

bool CollectionLoop::perturbed(const std::string& vehicle_id) const {
  return ego_planner_->perturbed().count(vehicle_id) != 0 ||
         cbv_planner_->perturbed().count(vehicle_id) != 0;
}

CollectionLoop::Decision CollectionLoop::decide() {
  const traffic::TrafficSnapshot& snapshot = world_->snapshot();
  const session::ScenarioOptions& options = setup_.options();
  Decision decision;
  decision.selection = driver_.update(snapshot);
  const auto ask = [&](planning::Planner& planner, const std::string& name,
                       const std::vector<planning::PlanningTask>& tasks) {
    session::PlannerLatency latency{name, 0.0};
    std::string fault;
    for (PlannedAction& action :
         session::planTimed(planner, snapshot, tasks, latency.milliseconds, fault)) {
      if (!fault.empty()) action.fault = fault;
      decision.actions.push_back(std::move(action));
    }
    if (!fault.empty()) world_->recordFault(name, fault);
    decision.latencies.push_back(latency);
  };
  ask(*ego_planner_, "ego:" + options.ego_planner,
      session::egoTasks(snapshot, setup_.egoRoute(), options.target_speed));
  ask(*cbv_planner_, "cbv:" + options.cbv_planner,
      session::cbvTasks(snapshot, decision.selection, options.target_speed));
  if (camera_) render(decision);
  return decision;
}

/// Whether it is a vehicle's turn, or a disturbance of it has just ended: what it does then is
/// worth more than what it does most of the time.
bool CollectionLoop::imageDue(const PlannedAction& action, std::int64_t decision) {
  const double period = setup_.options().decision_period;
  const auto every = std::max<std::int64_t>(1, std::llround(options_.image_period / period));
  if (perturbed(action.vehicle_id)) disturbed_[action.vehicle_id] = decision;
  const auto disturbed = disturbed_.find(action.vehicle_id);
  const std::int64_t since = disturbed == disturbed_.end() ? 0 : decision - disturbed->second;
  return since == 1 || since == 4 || (decision + action.slot + 1) % every == 0;
}

/// Images of driven vehicles; the first one after the take-over, so that no jump lies between image
/// and motion.
void CollectionLoop::render(Decision& decision) {
  const traffic::TrafficSnapshot& snapshot = world_->snapshot();
  const auto count = static_cast<std::int64_t>(snapshot.tick / setup_.ticksPerDecision());
  for (const PlannedAction& action : decision.actions) {
    const traffic::Vehicle* vehicle = snapshot.find(action.vehicle_id);
    if (vehicle == nullptr) continue;
    if (!vehicle->applied_action) disturbed_[action.vehicle_id] = count;
    if (!imageDue(action, count) || !vehicle->applied_action) continue;
    decision.images.push_back({action.slot, camera_->render(snapshot, *vehicle)});
  }
}

SessionStatus CollectionLoop::run(const std::atomic<bool>& stop) {
  while (true) {
    const traffic::TrafficSnapshot& snapshot = world_->snapshot();
    session::TickRecord record;
    record.snapshot = &snapshot;
    Decision decision;
    if (snapshot.decision_tick) {
      decision = decide();
      record.selection = &decision.selection;
      record.actions = &decision.actions;
      record.images = &decision.images;
      record.latencies = decision.latencies;
    } else {
      driver_.observe(snapshot);
    }
    for (session::SessionObserver* observer : observers_) observer->observe(record);
    if (snapshot.status != SessionStatus::kRunning) return snapshot.status;
    if (stop) {
      world_->end(SessionStatus::kInterrupted, {snapshot.tick, "user", "interrupted"});
      continue;
    }
    world_->advance(record.selection, decision.actions);
  }
}

}  // namespace cdiff::collection
