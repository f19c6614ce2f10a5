// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/collection_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collection/traffic_driver.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"

namespace cdiff::collection {

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

namespace {

std::uint64_t seedOf(const session::SessionSetup& setup) {
  return static_cast<std::uint64_t>(setup.options().seed);
}

std::unique_ptr<PerturbedPlanner> perturbedPlanner(const session::SessionSetup& setup,
                                                   const CollectionOptions& options,
                                                   std::unique_ptr<planning::Planner> planner,
                                                   const std::string& name) {
  if (planner->needsImages())
    throw core::InputError(
        "planner '" + name +
        "' needs images; data are collected with planners that do not, such as '" +
        std::string(planners::kDefaultEgoPlanner) + "'");
  return std::make_unique<PerturbedPlanner>(std::move(planner), options, seedOf(setup),
                                            setup.options().decision_period);
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

CollectionLoop::CollectionLoop(const session::SessionSetup& setup, const CollectionOptions& options,
                               bool images)
    : schedule_(std::llround(options.image_period / setup.options().decision_period)),
      loop_(setup, makeParts(setup, options, images)) {}

session::LoopParts CollectionLoop::makeParts(const session::SessionSetup& setup,
                                             const CollectionOptions& options, bool images) {
  auto ego = perturbedPlanner(setup, options, setup.makeEgoPlanner(), setup.options().ego_planner);
  auto cbv = perturbedPlanner(setup, options, setup.makeCbvPlanner(), setup.options().cbv_planner);
  ego_planner_ = ego.get();
  cbv_planner_ = cbv.get();
  session::LoopParts parts;
  parts.ego_planner = std::move(ego);
  parts.cbv_planner = std::move(cbv);
  parts.selector =
      std::make_unique<TrafficDriver>(options, setup.graph(), setup.drivableArea(), seedOf(setup));
  if (images) {
    parts.camera.emplace(setup.options().camera, setup.network());
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
