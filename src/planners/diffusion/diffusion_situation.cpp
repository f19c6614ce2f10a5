// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_situation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diffusion/network/architecture.h"
#include "dynamics/action_rollout.h"
#include "e2e_cdiff/core/angle.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {

GuidedBatch::GuidedBatch(const diffusion::Normalizer& normalizer,
                         std::vector<guidance::TotalObjective*> objectives)
    : normalizer_(normalizer), objectives_(std::move(objectives)) {}

bool GuidedBatch::actsAt(std::size_t sample, int k) const { return objectives_[sample]->actsAt(k); }

double GuidedBatch::evaluate(std::size_t sample, int k, const diffusion::Trajectory& clean,
                             diffusion::Trajectory& gradient) {
  const double value = objectives_[sample]->evaluate(k, normalizer_.denormalize(clean),
                                                     normalizer_.scale, metric_gradient_);
  gradient = normalizer_.toNormalizedGradient(metric_gradient_);
  return value;
}

namespace {

using traffic::Rollout;

/// Mean distance of two plans in the plane over their common rows, both seen from the same place
/// [m].
double planDistance(const Rollout& first, const Rollout& second) {
  const Eigen::Index rows = std::min(first.rows(), second.rows());
  return (first.topLeftCorner(rows, 2) - second.topLeftCorner(rows, 2)).rowwise().norm().mean();
}

std::vector<std::size_t> finitePlans(const std::vector<Rollout>& plans) {
  std::vector<std::size_t> finite;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    if (plans[i].allFinite()) finite.push_back(i);
  }
  return finite;
}

}  // namespace

std::size_t choosePlan(const std::vector<Rollout>& plans,
                       const std::vector<guidance::Score>& scores,
                       const std::optional<Rollout>& previous, double hysteresis) {
  const std::vector<std::size_t> finite = finitePlans(plans);
  if (finite.empty()) return 0;
  const std::size_t best =
      *std::min_element(finite.begin(), finite.end(),
                        [&](std::size_t a, std::size_t b) { return scores[a] < scores[b]; });
  if (!previous) return best;
  const std::size_t nearest =
      *std::min_element(finite.begin(), finite.end(), [&](std::size_t a, std::size_t b) {
        return planDistance(plans[a], *previous) < planDistance(plans[b], *previous);
      });
  if (scores[nearest].undefined != scores[best].undefined ||
      scores[nearest].off_road != scores[best].off_road)
    return best;
  const double margin = hysteresis * std::abs(scores[nearest].value);
  return scores[nearest].value - scores[best].value <= margin ? nearest : best;
}

namespace {

constexpr double kPlaceJump = 0.5;    // [m]
constexpr double kHeadingJump = 0.1;  // [rad]
constexpr double kSpeedJump = 0.5;    // [m/s]
constexpr double kRounding = 1e-6;    // of a row

std::optional<Eigen::Vector2d> goalOf(const map::Route* route) {
  if (route == nullptr || route->empty()) return std::nullopt;
  return route->path().points().back().head<2>();
}

}  // namespace

LastPlan::LastPlan(const traffic::Rollout& plan, std::uint64_t tick,
                   const traffic::VehicleState& start, const map::Route* route)
    : plan_(plan), tick_(tick), start_(start), goal_(goalOf(route)) {}

std::optional<traffic::Rollout> LastPlan::continued(double rows,
                                                    const dynamics::ActionRollout& dynamics,
                                                    const traffic::VehicleState& now) const {
  const auto shift = static_cast<Eigen::Index>(std::llround(rows));
  const bool whole = std::abs(rows - static_cast<double>(shift)) < kRounding;
  if (!whole || shift < 1 || shift > plan_.rows()) return std::nullopt;
  traffic::Rollout moved = plan_;
  for (Eigen::Index row = 0; row < plan_.rows(); ++row)
    moved.row(row) = plan_.row(std::min(row + shift, plan_.rows() - 1));
  dynamics::makeExecutable(moved);
  dynamics.rollOut(now.speed, moved);
  return moved;
}

bool LastPlan::holds(Eigen::Index rows, const traffic::VehicleState& now,
                     const map::Route* route) const {
  const auto row = plan_.row(rows - 1);
  const Eigen::Vector2d place = start_.pose().toMap(row.head<2>().transpose());
  const double heading = start_.heading + row(traffic::kRolloutHeading);
  const std::optional<Eigen::Vector2d> goal = goalOf(route);
  const bool same_goal =
      goal.has_value() == goal_.has_value() && (!goal || (*goal - *goal_).norm() < kPlaceJump);
  return same_goal && (place - now.position).norm() < kPlaceJump &&
         std::abs(core::angleDifference(heading, now.heading)) < kHeadingJump &&
         std::abs(row(traffic::kRolloutSpeed) - now.speed) < kSpeedJump;
}

namespace {

/// Rows of a rollout in a decision period.
double rowsOf(const planning::PlanningContext& context) {
  return context.decision_period / traffic::kRolloutStep;
}

std::uint64_t ticksOf(const planning::PlanningContext& context) {
  return static_cast<std::uint64_t>(
      std::llround(context.decision_period / context.simulation_step));
}

}  // namespace

void DiffusionPlanner::setCompanions(
    const std::vector<std::pair<const planning::PlanningTask*, Memory*>>& seen) {
  companions_.clear();
  std::vector<guidance::RoutedVehicle> routed;
  const auto steps = static_cast<std::size_t>(model_.architecture.horizon);
  for (const auto& [task, memory] : seen) {
    if (task->route == nullptr || task->route->empty()) continue;
    const traffic::Vehicle& vehicle = *task->vehicle;
    memory->follower.update(*task->route, vehicle.state.position);
    if (!conditions_on_route_) continue;
    const double arc_length = memory->follower.arcLength();
    companions_[vehicle.id] = {
        vehicle.state, vehicle.dimensions,
        planning::forecastAlongRoute(vehicle, *task->route, arc_length, steps), true, false};
    routed.push_back({vehicle.id, vehicle.state, vehicle.dimensions, task->route, arc_length,
                      task->target_speed});
  }
  right_of_way_ = guidance::RightOfWay(routed);
}

guidance::OtherMotion DiffusionPlanner::motionOf(const traffic::Vehicle& near,
                                                 const traffic::Vehicle& planned) const {
  const auto companion = companions_.find(near.id);
  if (companion != companions_.end()) {
    guidance::OtherMotion motion = companion->second;
    motion.goes_first = !right_of_way_.mayGo(planned.id, near.id);
    return motion;
  }
  const auto steps = static_cast<std::size_t>(model_.architecture.horizon);
  return {near.state, near.dimensions,
          planning::forecastMotion(near, context_.network, vehicle_, steps), false, false};
}

/// For a CBV the other is the ego along its route; for the ego the nearest other vehicle. The
/// vehicles around both are the traffic.
void DiffusionPlanner::setOther(const traffic::TrafficSnapshot& snapshot, Situation& situation) {
  const traffic::Vehicle& vehicle = *situation.task->vehicle;
  const auto steps = static_cast<std::size_t>(model_.architecture.horizon);
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
                                                 ego_follower_.arcLength(), steps)
                  : planning::forecastMotion(*other, context_.network, vehicle_, steps);
  situation.scene.other = &situation.other;
}

/// The last plan, seen from here one decision later; it is a warm start if the vehicle is where the
/// plan said, toward the same goal.
void DiffusionPlanner::setWarmStart(std::uint64_t tick, Situation& situation) const {
  const std::optional<LastPlan>& last = situation.memory->plan;
  if (!last || last->tick() + ticksOf(context_) != tick) return;
  const planning::PlanningTask& task = *situation.task;
  const double rows = rowsOf(context_);
  situation.previous = last->continued(rows, exact_, task.vehicle->state);
  if (situation.previous && options_.sampler.warm_start &&
      last->holds(std::lround(rows), task.vehicle->state, task.route))
    situation.warm = model_.normalizer.normalize(*situation.previous);
}

/// Encodes each image unless it is the one of the last decision, as before a standing vehicle.
void DiffusionPlanner::encodeImages(
    const std::vector<std::pair<const planning::PlanningTask*, Memory*>>& seen) {
  std::vector<std::pair<const planning::PlanningTask*, Memory*>> changed;
  for (const auto& [task, memory] : seen) {
    const std::uint64_t hash = memory->watch.imageHash();
    if (!memory->features.empty() && memory->features_hash == hash) continue;
    memory->features_hash = hash;
    changed.emplace_back(task, memory);
  }
  forEachWorker(changed.size(), [&](Worker& worker, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      changed[i].second->features =
          worker.encoder().encode(*changed[i].first->views.find(rendering::kFrontCamera));
  });
}

std::uint64_t DiffusionPlanner::ticksToPrevious() const {
  const auto steps = static_cast<double>(model_.architecture.previous_frame);
  return static_cast<std::uint64_t>(
      std::llround(steps * traffic::kRolloutStep / context_.simulation_step));
}

/// Keeps the features of this decision and of those since the image before.
void DiffusionPlanner::rememberFeatures(
    std::uint64_t tick,
    const std::vector<std::pair<const planning::PlanningTask*, Memory*>>& seen) const {
  const std::uint64_t back = ticksToPrevious();
  if (back == 0) return;
  for (const auto& [task, memory] : seen) {
    std::map<std::uint64_t, std::vector<float>>& earlier = memory->earlier;
    earlier[tick] = memory->features;
    earlier.erase(earlier.begin(), earlier.lower_bound(tick - std::min(tick, back)));
  }
}

void DiffusionPlanner::addMotion(std::uint64_t tick, Situation& situation) const {
  const std::uint64_t back = ticksToPrevious();
  const auto& earlier = situation.memory->earlier;
  const auto before = back > 0 && tick >= back ? earlier.find(tick - back) : earlier.end();
  const auto given = [&](const char* input) {
    return options_.motion == "all" || options_.motion == input;
  };
  if (before != earlier.end() && given("previous_image"))
    situation.context.previous = before->second;
  if (model_.architecture.takesTarget() && given("target_speed"))
    situation.context.target_speed = situation.task->target_speed;
}

std::unique_ptr<DiffusionPlanner::Situation> DiffusionPlanner::situationOf(
    const traffic::TrafficSnapshot& snapshot, const planning::PlanningTask& task, Memory& memory) {
  auto situation = std::make_unique<Situation>();
  situation->task = &task;
  situation->memory = &memory;
  const traffic::Vehicle& vehicle = *task.vehicle;
  guidance::GuidanceScene& scene = situation->scene;
  scene.state = vehicle.state;
  scene.dimensions = vehicle.dimensions;
  scene.target_speed = task.target_speed;
  scene.drivable_area = &context_.drivable_area;
  situation->context.speed = vehicle.state.speed;
  situation->context.image_features = memory.features;
  if (task.route != nullptr && !task.route->empty()) {
    const double arc_length = memory.follower.arcLength();
    scene.route = task.route;
    scene.route_arc_length = arc_length;
    const double place = std::clamp(arc_length, 0.0, task.route->length());
    scene.target_speed = std::min(task.target_speed, task.route->speedLimitAt(place));
    if (conditions_on_route_) {
      situation->context.route = diffusion::routeTokens(model_.architecture, task.route->path(),
                                                        arc_length, vehicle.state.pose());
    }
  }
  if (conditions_on_route_) addMotion(snapshot.tick, *situation);
  setOther(snapshot, *situation);
  setWarmStart(snapshot.tick, *situation);
  const guidance::TotalObjective prepared(guidance_, scene);
  for (std::int64_t i = 0; i < guidance_.candidates; ++i)
    situation->objectives.push_back(std::make_unique<guidance::TotalObjective>(prepared));
  return situation;
}

}  // namespace cdiff::planners
