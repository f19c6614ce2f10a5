// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_situation.h"

#include <algorithm>
#include <cmath>

#include "diffusion/network/architecture.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {

AimedScene::AimedScene(const guidance::GuidanceScene& original, const guidance::OtherMotion& other,
                       double ahead)
    : motion(other), scene(original) {
  for (traffic::VehicleState& state : motion.predicted)
    state.position += ahead * geometry::direction(state.heading);
  scene.other = &motion;
}

SituationMaker::SituationMaker(const DiffusionOptions& options,
                               const guidance::GuidanceOptions& guidance,
                               const dynamics::BicycleModelOptions& vehicle,
                               const planning::PlanningContext& context,
                               const diffusion::Model& model, const dynamics::ActionRollout& exact)
    : options_(options),
      guidance_(guidance),
      vehicle_(vehicle),
      context_(context),
      model_(model),
      exact_(exact) {}

std::uint64_t SituationMaker::ticksToPrevious() const {
  const auto steps = static_cast<double>(model_.architecture.previous_frame);
  return static_cast<std::uint64_t>(
      std::llround(steps * traffic::kRolloutStep / context_.simulation_step));
}

void SituationMaker::followEgo(const traffic::TrafficSnapshot& snapshot) {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr || context_.ego_route == nullptr || context_.ego_route->empty()) return;
  if (!planning::isFinite(ego->state)) return;
  ego_follower_.update(*context_.ego_route, snapshot, context_.simulation_step);
}

void SituationMaker::startDecision(const traffic::TrafficSnapshot& snapshot,
                                   const std::vector<PlannedVehicle>& planned) {
  followEgo(snapshot);
  companions_.clear();
  std::vector<guidance::RoutedVehicle> routed;
  for (const auto& [task, memory] : planned) {
    if (task->route == nullptr || task->route->empty()) continue;
    const traffic::Vehicle& vehicle = *task->vehicle;
    memory->follower.update(*task->route, vehicle.state.position);
    if (!conditionsOnRoute()) continue;
    const double arc_length = memory->follower.arcLength();
    companions_[vehicle.id] = {
        vehicle.state, vehicle.dimensions,
        planning::forecastAlongRoute(vehicle, *task->route, arc_length, horizon()), true, false};
    routed.push_back({vehicle.id, vehicle.state, vehicle.dimensions, task->route, arc_length,
                      task->target_speed});
  }
  right_of_way_ = guidance::RightOfWay(routed);
}

guidance::OtherMotion SituationMaker::motionOf(const traffic::Vehicle& near,
                                               const traffic::Vehicle& planned) const {
  const auto companion = companions_.find(near.id);
  if (companion != companions_.end()) {
    guidance::OtherMotion motion = companion->second;
    motion.goes_first = !right_of_way_.mayGo(planned.id, near.id);
    return motion;
  }
  return {near.state, near.dimensions,
          planning::forecastMotion(near, context_.network, vehicle_, horizon()), false, false};
}

/// For a CBV the other is the ego along its route; for the ego the nearest other vehicle. The
/// vehicles around both are the traffic.
void SituationMaker::setOther(const traffic::TrafficSnapshot& snapshot,
                              DiffusionSituation& situation) const {
  const traffic::Vehicle& vehicle = *situation.task->vehicle;
  const traffic::Vehicle* ego = snapshot.ego();
  const bool about_ego = situation.task->slot >= 0;
  const traffic::Vehicle* other = about_ego ? ego : planning::nearestVehicle(snapshot, vehicle);
  for (const traffic::Vehicle* near : planning::vehiclesAround(snapshot, vehicle, other)) {
    situation.scene.traffic.push_back(motionOf(*near, vehicle));
  }
  if (other == nullptr || !planning::isFinite(other->state) ||
      traffic::onDifferentLevels(*other, vehicle))
    return;
  situation.other.now = other->state;
  situation.other.dimensions = other->dimensions;
  const bool along_route =
      about_ego && context_.ego_route != nullptr && !context_.ego_route->empty();
  situation.other.predicted =
      along_route ? planning::forecastAlongRoute(*other, *context_.ego_route,
                                                 ego_follower_.arcLength(), horizon())
                  : planning::forecastMotion(*other, context_.network, vehicle_, horizon());
  situation.scene.other = &situation.other;
}

/// The last plan, seen from here one decision later; it is a warm start if the vehicle is where the
/// plan said, toward the same goal.
void SituationMaker::setWarmStart(std::uint64_t tick, const std::optional<LastPlan>& last,
                                  DiffusionSituation& situation) const {
  const auto ticks =
      static_cast<std::uint64_t>(std::llround(context_.decision_period / context_.simulation_step));
  if (!last || last->tick() + ticks != tick) return;
  const planning::PlanningTask& task = *situation.task;
  const double rows = context_.decision_period / traffic::kRolloutStep;
  situation.previous = last->continued(rows, exact_, task.vehicle->state);
  if (situation.previous && options_.sampler.warm_start &&
      last->holds(std::lround(rows), task.vehicle->state, task.route))
    situation.warm = model_.normalizer.normalize(*situation.previous);
}

void SituationMaker::addMotion(std::uint64_t tick, const DiffusionMemory& memory,
                               DiffusionSituation& situation) const {
  const std::vector<float>* before = memory.featuresBefore(tick, ticksToPrevious());
  const auto given = [&](const char* input) {
    return options_.motion == "all" || options_.motion == input;
  };
  if (before != nullptr && given("previous_image")) situation.context.previous = *before;
  if (model_.architecture.takesTarget() && given("target_speed"))
    situation.context.target_speed = situation.task->target_speed;
}

void SituationMaker::setRoute(const PlannedVehicle& vehicle, DiffusionSituation& situation) const {
  const planning::PlanningTask& task = *vehicle.task;
  if (task.route == nullptr || task.route->empty()) return;
  const double arc_length = vehicle.memory->follower.arcLength();
  guidance::GuidanceScene& scene = situation.scene;
  scene.route = task.route;
  scene.route_arc_length = arc_length;
  const double place = std::clamp(arc_length, 0.0, task.route->length());
  scene.target_speed = std::min(task.target_speed, task.route->speedLimitAt(place));
  if (!conditionsOnRoute()) return;
  situation.context.route = diffusion::routeTokens(model_.architecture, task.route->path(),
                                                   arc_length, task.vehicle->state.pose());
}

/// One per candidate: of one scene, or of several in turn.
void SituationMaker::addObjectives(DiffusionSituation& situation) const {
  std::vector<guidance::TotalObjective> prepared;
  if (guidance_.challenge != "off" && situation.scene.other != nullptr) {
    for (const double ahead : {3.0, 6.0, 10.0, 15.0}) {  // [m]
      situation.aims.push_back(
          std::make_unique<AimedScene>(situation.scene, situation.other, ahead));
      prepared.emplace_back(guidance_, situation.aims.back()->scene);
    }
  } else {
    prepared.emplace_back(guidance_, situation.scene);
  }
  for (std::int64_t i = 0; i < guidance_.candidates; ++i) {
    const auto& objective = prepared[static_cast<std::size_t>(i) % prepared.size()];
    situation.objectives.push_back(std::make_unique<guidance::TotalObjective>(objective));
  }
}

std::unique_ptr<DiffusionSituation> SituationMaker::make(const traffic::TrafficSnapshot& snapshot,
                                                         const PlannedVehicle& vehicle) const {
  auto situation = std::make_unique<DiffusionSituation>();
  const planning::PlanningTask& task = *vehicle.task;
  const DiffusionMemory& memory = *vehicle.memory;
  situation->task = &task;
  guidance::GuidanceScene& scene = situation->scene;
  scene.state = task.vehicle->state;
  scene.dimensions = task.vehicle->dimensions;
  scene.target_speed = task.target_speed;
  scene.drivable_area = &context_.drivable_area;
  situation->context.speed = task.vehicle->state.speed;
  situation->context.image_features = memory.features;
  setRoute(vehicle, *situation);
  if (conditionsOnRoute()) addMotion(snapshot.tick, memory, *situation);
  setOther(snapshot, *situation);
  setWarmStart(snapshot.tick, memory.plan, *situation);
  addObjectives(*situation);
  return situation;
}

}  // namespace cdiff::planners
