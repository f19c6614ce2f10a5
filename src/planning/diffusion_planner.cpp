// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/diffusion_planner.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/diffusion/route_tokens.h"
#include "e2e_cdiff/planning/guided_batch.h"
#include "e2e_cdiff/planning/motion_forecast.h"
#include "e2e_cdiff/planning/route_forecast.h"

namespace cdiff::planning {
namespace {

using diffusion::SampledTrajectory;
using traffic::Rollout;

constexpr double kLeastBrake = 0.05;  // below it the sampled brake is noise around none

bool isFinite(const traffic::VehicleState& state) {
  return state.position.allFinite() && std::isfinite(state.elevation) &&
         std::isfinite(state.heading) && std::isfinite(state.speed);
}

/// Mean distance of two plans in the plane over their common rows, both seen from the same place
/// [m].
double planDistance(const Rollout& first, const Rollout& second) {
  const Eigen::Index rows = std::min(first.rows(), second.rows());
  return (first.topLeftCorner(rows, 2) - second.topLeftCorner(rows, 2)).rowwise().norm().mean();
}

const traffic::Vehicle* nearestOther(const traffic::TrafficSnapshot& snapshot,
                                     const traffic::Vehicle& vehicle) {
  const traffic::Vehicle* nearest = nullptr;
  double least = 0.0;
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    if (other.id == vehicle.id || traffic::onDifferentLevels(other, vehicle)) continue;
    const double distance = (other.state.position - vehicle.state.position).norm();
    if (nearest != nullptr && distance >= least) continue;
    nearest = &other;
    least = distance;
  }
  return nearest;
}

}  // namespace

traffic::ControlAction executableAction(const Rollout& rollout, Eigen::Index row) {
  traffic::ControlAction action;
  action.throttle = std::clamp(rollout(row, traffic::kRolloutThrottle), 0.0, 1.0);
  action.steer = std::clamp(rollout(row, traffic::kRolloutSteer), -1.0, 1.0);
  action.brake = std::clamp(rollout(row, traffic::kRolloutBrake), 0.0, 1.0);
  if (action.brake < kLeastBrake || action.brake < action.throttle)
    action.brake = 0.0;
  else
    action.throttle = 0.0;
  return action;
}

/// What is remembered of a vehicle between decisions.
struct DiffusionPlanner::Memory {
  RouteFollower follower;
  ImageWatch watch;
  std::optional<Rollout> plan;  ///< of the last decision
  std::uint64_t plan_tick = 0;
  std::vector<float> features;  ///< of the last image
  std::uint64_t features_hash = 0;
};

/// One vehicle of this decision.
struct DiffusionPlanner::Situation {
  const PlanningTask* task = nullptr;
  Memory* memory = nullptr;
  diffusion::Context context;
  guidance::GuidanceScene scene;
  guidance::OtherMotion other;
  std::optional<Rollout> previous;            ///< last plan as seen from here, metric
  std::optional<diffusion::Trajectory> warm;  ///< the same, normalised, where it fits
  std::unique_ptr<guidance::TotalObjective> objective;
  Rollout plan;  ///< the chosen one
  guidance::GuidanceReport report;
};

DiffusionPlanner::DiffusionPlanner(const DiffusionOptions& options,
                                   const guidance::GuidanceOptions& guidance,
                                   const dynamics::BicycleModelOptions& vehicle,
                                   const PlanningContext& context)
    : options_(options),
      guidance_(guidance),
      vehicle_(vehicle),
      context_(context),
      model_(diffusion::loadModel(options.model)),
      schedule_(static_cast<int>(model_.architecture.diffusion_steps)),
      encoder_(model_),
      denoiser_(model_),
      sampler_(options.sampler, schedule_, model_.spread,
               core::RandomStream(context.seed, "diffusion")),
      exact_(vehicle) {
  guidance_.validate();
}

DiffusionPlanner::~DiffusionPlanner() = default;

std::optional<std::string> DiffusionPlanner::faultOf(const PlanningTask& task, std::uint64_t tick,
                                                     Memory& memory) {
  if (!isFinite(task.vehicle->state)) return "its state is not finite";
  const diffusion::Architecture& sizes = model_.architecture;
  const ImageExpectation expectation{static_cast<int>(sizes.image_width),
                                     static_cast<int>(sizes.image_height),
                                     options_.frozen_image_time, context_.simulation_step};
  if (auto fault = memory.watch.fault(expectation, task.image, task.vehicle->state, tick))
    return fault;
  const bool has_route = task.route != nullptr && !task.route->empty();
  if (!has_route && options_.conditioning == "image_route") return "it has no route";
  return std::nullopt;
}

/// For a CBV the ego along its route; for the ego the nearest other vehicle.
void DiffusionPlanner::setOther(const traffic::TrafficSnapshot& snapshot, Situation& situation) {
  const traffic::Vehicle& vehicle = *situation.task->vehicle;
  const auto steps = static_cast<std::size_t>(model_.architecture.horizon);
  const traffic::Vehicle* ego = snapshot.ego();
  const bool about_ego = situation.task->slot >= 0;
  const traffic::Vehicle* other = about_ego ? ego : nearestOther(snapshot, vehicle);
  if (other == nullptr || !isFinite(other->state) || traffic::onDifferentLevels(*other, vehicle))
    return;
  situation.other.now = other->state;
  situation.other.dimensions = other->dimensions;
  const bool along_route =
      about_ego && context_.ego_route != nullptr && !context_.ego_route->empty();
  situation.other.predicted =
      along_route
          ? forecastAlongRoute(*other, *context_.ego_route, ego_follower_.arcLength(), steps)
          : forecastMotion(*other, context_.network, vehicle_, steps);
  situation.scene.other = &situation.other;
}

/// The last plan, seen from here one decision later; it is a warm start if the vehicle drives as
/// fast as the plan said. A decision period that is no whole number of rows has none.
void DiffusionPlanner::setWarmStart(std::uint64_t tick, Situation& situation) const {
  constexpr double kJump = 0.5;       // [m/s]
  constexpr double kRounding = 1e-6;  // of a row
  const Memory& memory = *situation.memory;
  const auto period =
      static_cast<std::uint64_t>(std::llround(context_.decision_period / context_.simulation_step));
  const double rows = context_.decision_period / traffic::kRolloutStep;
  const auto shift = static_cast<Eigen::Index>(std::llround(rows));
  if (!memory.plan || memory.plan_tick + period != tick) return;
  const Rollout& last = *memory.plan;
  const bool whole = std::abs(rows - static_cast<double>(shift)) < kRounding;
  if (!whole || shift < 1 || shift > last.rows()) return;
  Rollout moved = last;
  for (Eigen::Index row = 0; row < last.rows(); ++row)
    moved.row(row) = last.row(std::min(row + shift, last.rows() - 1));
  const double speed = situation.task->vehicle->state.speed;
  const double expected = last(shift - 1, traffic::kRolloutSpeed);
  exact_.rollOut(speed, moved);
  situation.previous = moved;
  if (options_.sampler.mode == "real_time" && options_.sampler.warm_start &&
      std::abs(speed - expected) < kJump)
    situation.warm = model_.normalizer.normalize(moved);
}

/// Encodes an image unless it is the one of the last decision, as before a standing vehicle.
const std::vector<float>& DiffusionPlanner::featuresOf(const traffic::CameraImage& image,
                                                       Memory& memory) {
  const std::uint64_t hash = memory.watch.imageHash();
  if (memory.features.empty() || memory.features_hash != hash) {
    memory.features = encoder_.encode(image);
    memory.features_hash = hash;
  }
  return memory.features;
}

std::unique_ptr<DiffusionPlanner::Situation> DiffusionPlanner::situationOf(
    const traffic::TrafficSnapshot& snapshot, const PlanningTask& task, Memory& memory) {
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
  situation->context.image_features = featuresOf(*task.image, memory);
  if (task.route != nullptr && !task.route->empty()) {
    memory.follower.update(*task.route, vehicle.state.position);
    const double arc_length = memory.follower.arcLength();
    scene.route = task.route;
    scene.route_arc_length = arc_length;
    const double place = std::clamp(arc_length, 0.0, task.route->length());
    scene.target_speed = std::min(task.target_speed, task.route->speedLimitAt(place));
    if (options_.conditioning == "image_route") {
      situation->context.route = diffusion::routeTokens(model_.architecture, task.route->path(),
                                                        arc_length, vehicle.state.pose());
    }
  }
  setOther(snapshot, *situation);
  setWarmStart(snapshot.tick, *situation);
  situation->objective = std::make_unique<guidance::TotalObjective>(guidance_, scene);
  return situation;
}

/// Samples one batch: all candidates of all `situations`.
void DiffusionPlanner::solve(std::uint64_t tick, const std::vector<Situation*>& situations) {
  if (situations.empty()) return;
  const auto candidates = static_cast<std::uint32_t>(options_.candidates);
  std::vector<diffusion::Context> contexts;
  std::vector<double> speeds;
  std::vector<diffusion::SampleRequest> requests;
  std::vector<guidance::TotalObjective*> objectives;
  for (const Situation* situation : situations) {
    for (std::uint32_t candidate = 0; candidate < candidates; ++candidate) {
      contexts.push_back(situation->context);
      speeds.push_back(situation->context.speed);
      diffusion::SampleRequest request;
      request.key = {core::hashText(situation->task->vehicle->id), static_cast<std::uint32_t>(tick),
                     0};
      request.candidate = candidate;
      request.warm = situation->warm ? &*situation->warm : nullptr;
      requests.push_back(request);
      objectives.push_back(situation->objective.get());
    }
  }
  denoiser_.setContexts(contexts);
  std::unique_ptr<diffusion::StateBranch> branch;
  if (options_.state_branch == "exact") {
    branch = std::make_unique<diffusion::ExactStateBranch>(vehicle_, model_.normalizer, speeds);
  } else {
    branch = std::make_unique<diffusion::LearnedStateBranch>(denoiser_);
  }
  GuidedBatch guided(model_.normalizer, objectives);
  const auto samples = sampler_.sample(denoiser_, *branch, requests, &guided);
  for (std::size_t i = 0; i < situations.size(); ++i)
    choose(*situations[i], samples, i * candidates);
}

void DiffusionPlanner::choose(Situation& situation, const std::vector<SampledTrajectory>& samples,
                              std::size_t first) const {
  const auto count = static_cast<std::size_t>(options_.candidates);
  std::vector<Rollout> plans;
  std::vector<double> scores;
  for (std::size_t i = 0; i < count; ++i) {
    plans.push_back(model_.normalizer.denormalize(samples[first + i].clean));
    scores.push_back(count > 1 ? situation.objective->score(plans.back()) : 0.0);
  }
  auto chosen =
      static_cast<std::size_t>(std::min_element(scores.begin(), scores.end()) - scores.begin());
  if (situation.previous && count > 1) {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < count; ++i) {
      if (planDistance(plans[i], *situation.previous) <
          planDistance(plans[nearest], *situation.previous))
        nearest = i;
    }
    const double margin = options_.hysteresis * std::abs(scores[nearest]);
    if (scores[nearest] - scores[chosen] <= margin) chosen = nearest;
  }
  situation.plan = plans[chosen];
  situation.report = situation.objective->report(situation.plan);
  situation.report.candidates = static_cast<std::int64_t>(count);
  situation.report.chosen = static_cast<std::int64_t>(chosen);
  const SampledTrajectory& sample = samples[first + chosen];
  if (sample.guided_steps > 0) {
    situation.report.trust_region_share =
        static_cast<double>(sample.trust_region_hits) / static_cast<double>(sample.guided_steps);
  }
}

PlannedAction DiffusionPlanner::actionOf(const Situation& situation) const {
  const PlanningTask& task = *situation.task;
  const traffic::VehicleState& start = task.vehicle->state;
  PlannedAction planned{task.slot, task.vehicle->id, executableAction(situation.plan, 0), {}};
  planned.guidance = situation.report;
  Rollout driven = situation.plan;
  for (Eigen::Index row = 0; row < driven.rows(); ++row) {
    const traffic::ControlAction action = executableAction(situation.plan, row);
    driven.row(row).tail<traffic::kActionColumns>() << action.throttle, action.steer, action.brake;
    traffic::VehicleState state = start;
    state.position = start.pose().toMap(situation.plan.row(row).head<2>().transpose());
    state.heading = core::wrapAngle(start.heading + situation.plan(row, traffic::kRolloutHeading));
    state.speed = std::max(0.0, situation.plan(row, traffic::kRolloutSpeed));
    planned.rollout.push_back({state, action});
  }
  exact_.rollOut(start.speed, driven);
  planned.state_mismatch =
      (driven.leftCols<2>() - situation.plan.leftCols<2>()).rowwise().norm().maxCoeff();
  return planned;
}

void DiffusionPlanner::followEgo(const traffic::TrafficSnapshot& snapshot) {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr || context_.ego_route == nullptr || context_.ego_route->empty()) return;
  if (isFinite(ego->state)) ego_follower_.update(*context_.ego_route, ego->state.position);
}

void DiffusionPlanner::rememberOnly(const std::vector<PlanningTask>& tasks) {
  std::map<std::string, std::unique_ptr<Memory>> kept;
  for (const PlanningTask& task : tasks) {
    std::unique_ptr<Memory>& known = memories_[task.vehicle->id];
    kept[task.vehicle->id] = known ? std::move(known) : std::make_unique<Memory>();
  }
  memories_ = std::move(kept);
}

/// The chosen plan becomes the vehicle's action, unless it cannot be executed.
void DiffusionPlanner::conclude(std::uint64_t tick, const Situation& situation,
                                PlannedAction& planned) const {
  if (!situation.plan.allFinite()) {
    planned.fault = "vehicle '" + planned.vehicle_id +
                    "': the sampled plan is not finite; full braking instead";
    situation.memory->plan.reset();
    return;
  }
  planned = actionOf(situation);
  situation.memory->plan = situation.plan;
  situation.memory->plan_tick = tick;
}

std::vector<PlannedAction> DiffusionPlanner::plan(const traffic::TrafficSnapshot& snapshot,
                                                  const std::vector<PlanningTask>& tasks) {
  followEgo(snapshot);
  rememberOnly(tasks);
  std::vector<PlannedAction> actions;
  std::vector<std::unique_ptr<Situation>> situations(tasks.size());
  std::vector<Situation*> cold;
  std::vector<Situation*> warm;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const std::string& id = tasks[i].vehicle->id;
    actions.push_back({tasks[i].slot, id, traffic::ControlAction::failSafe(), {}});
    Memory& memory = *memories_[id];
    if (auto fault = faultOf(tasks[i], snapshot.tick, memory)) {
      actions[i].fault = "vehicle '" + id + "': " + *fault + "; full braking instead";
      memory.plan.reset();
      continue;
    }
    situations[i] = situationOf(snapshot, tasks[i], memory);
    (situations[i]->warm ? warm : cold).push_back(situations[i].get());
  }
  solve(snapshot.tick, cold);
  solve(snapshot.tick, warm);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (situations[i]) conclude(snapshot.tick, *situations[i], actions[i]);
  }
  return actions;
}

}  // namespace cdiff::planning
