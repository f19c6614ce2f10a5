// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_planner.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "dynamics/action_rollout.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "planners/diffusion/diffusion_options.h"
#include "planners/diffusion/diffusion_situation.h"
#include "planners/diffusion/image_watch.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {

namespace {

using diffusion::SampledTrajectory;
using traffic::Rollout;

diffusion::SamplerOptions samplerOptions(const DiffusionOptions& options,
                                         const guidance::GuidanceOptions& guidance) {
  diffusion::SamplerOptions sampler = options.sampler;
  sampler.trust_region = guidance.trust_region;
  sampler.noise_correlation = guidance.noise_correlation;
  return sampler;
}

inference::InstructionSet instructionSetOf(const DiffusionOptions& options) {
  return inference::instructionSetNamed(options.isa, "diffusion.isa");
}

diffusion::ImageEncoder encoderFor(const DiffusionOptions& options, const diffusion::Model& model) {
  inference::pinOneDnn(options.isa, "diffusion.isa");
  const inference::Precision precision =
      inference::precisionNamed(options.precision, options.isa, "diffusion.precision");
  return diffusion::ImageEncoder(model, precision, instructionSetOf(options));
}

/// Throws InputError for a conditioning that gives vehicles a route, and for a choice of further
/// inputs, which the model does not take.
void requireInputs(const DiffusionOptions& options, const diffusion::Model& model) {
  const bool moves = model.architecture.takesPrevious() || model.architecture.takesTarget();
  if (options.motion != "all" && !moves)
    throw core::InputError("key 'diffusion.motion' is '" + options.motion + "', and model '" +
                           model.name +
                           "' takes neither the image before nor the target speed; "
                           "expected 'all'");
  if (model.architecture.takesRoute() || options.conditioning == "image") return;
  throw core::InputError("key 'diffusion.conditioning' is '" + options.conditioning +
                         "', and model '" + model.name + "' takes no route; expected 'image'");
}

}  // namespace

Worker::Worker(const DiffusionOptions& options, const diffusion::Model& model, bool scaled_route)
    : encoder_(encoderFor(options, model)), denoiser_(model, instructionSetOf(options)) {
  if (!scaled_route) return;
  routeless_ = std::make_unique<diffusion::CpuDenoiser>(model, instructionSetOf(options));
  scaled_ =
      std::make_unique<diffusion::RouteScaledDenoiser>(denoiser_, *routeless_, options.route_scale);
}

diffusion::Denoiser& Worker::denoiser() {
  if (scaled_) return *scaled_;
  return denoiser_;
}

DiffusionPlanner::DiffusionPlanner(const DiffusionOptions& options,
                                   const guidance::GuidanceOptions& guidance,
                                   const dynamics::BicycleModelOptions& vehicle,
                                   const planning::PlanningContext& context,
                                   const std::string& guidance_group)
    : options_(options),
      guidance_(guidance),
      conditions_on_route_(options.conditioningUnder(guidance) == "image_route"),
      vehicle_(vehicle),
      context_(context),
      model_(diffusion::loadModel(options.model)),
      schedule_(static_cast<int>(model_.architecture.diffusion_steps)),
      sampler_(samplerOptions(options, guidance), schedule_, model_.spread,
               core::RandomStream(context.seed, "diffusion")),
      exact_(vehicle, dynamics::throttleResponse(options.response)) {
  options_.validate();
  guidance_.validate(guidance_group);
  requireInputs(options, model_);
  const bool scaled = conditions_on_route_ && options.route_scale != 1.0;
  for (std::int64_t i = 0; i < options.threads; ++i)
    workers_.push_back(std::make_unique<Worker>(options, model_, scaled));
  if (options.sampler.mode != "unguided") {
    guidance_.validateWindows(schedule_.steps(), sampler_.visitedSteps(false), guidance_group);
  }
}

DiffusionPlanner::~DiffusionPlanner() = default;

std::optional<std::string> DiffusionPlanner::faultOf(const planning::PlanningTask& task,
                                                     std::uint64_t tick, Memory& memory) {
  if (!planning::isFinite(task.vehicle->state)) return "its state is not finite";
  const diffusion::Architecture& sizes = model_.architecture;
  const ImageExpectation expectation{static_cast<int>(sizes.image_width),
                                     static_cast<int>(sizes.image_height),
                                     options_.frozen_image_time, context_.simulation_step};
  if (auto fault = memory.watch.fault(expectation, task.views.find(rendering::kFrontCamera),
                                      task.vehicle->state, tick))
    return fault;
  const bool has_route = task.route != nullptr && !task.route->empty();
  if (!has_route && conditions_on_route_) return "it has no route";
  return std::nullopt;
}

std::unique_ptr<diffusion::StateBranch> DiffusionPlanner::stateBranch(
    diffusion::Denoiser& denoiser, const std::vector<diffusion::Context>& contexts) const {
  if (options_.state_branch == "learned")
    return std::make_unique<diffusion::LearnedStateBranch>(denoiser);
  std::vector<double> speeds;
  for (const diffusion::Context& context : contexts) speeds.push_back(context.speed);
  return std::make_unique<diffusion::ExactStateBranch>(
      vehicle_, model_.normalizer, speeds, dynamics::throttleResponse(options_.response));
}

void DiffusionPlanner::forEachWorker(std::size_t count, const WorkerPart& part) {
  const std::size_t workers = std::min(workers_.size(), count);
  std::vector<std::future<void>> others;
  for (std::size_t i = 1; i < workers; ++i) {
    others.push_back(std::async(std::launch::async, [&, i] {
      part(*workers_[i], i * count / workers, (i + 1) * count / workers);
    }));
  }
  if (workers > 0) part(*workers_[0], 0, count / workers);
  for (std::future<void>& other : others) other.get();
}

void DiffusionPlanner::solveByWorkers(std::uint64_t tick,
                                      const std::vector<Situation*>& situations) {
  forEachWorker(situations.size(), [&](Worker& worker, std::size_t begin, std::size_t end) {
    solve(tick, worker,
          {situations.begin() + static_cast<long>(begin),
           situations.begin() + static_cast<long>(end)});
  });
}

/// Samples one batch: all candidates of all `situations`.
void DiffusionPlanner::solve(std::uint64_t tick, Worker& worker,
                             const std::vector<Situation*>& situations) {
  std::vector<diffusion::Context> contexts;
  std::vector<diffusion::SampleRequest> requests;
  std::vector<guidance::TotalObjective*> objectives;
  for (const Situation* situation : situations) {
    for (std::size_t candidate = 0; candidate < situation->objectives.size(); ++candidate) {
      contexts.push_back(situation->context);
      diffusion::SampleRequest request;
      request.key = {core::hashText(situation->task->vehicle->id), static_cast<std::uint32_t>(tick),
                     0};
      request.candidate = static_cast<std::uint32_t>(candidate);
      request.warm = situation->warm ? &*situation->warm : nullptr;
      requests.push_back(request);
      objectives.push_back(situation->objectives[candidate].get());
    }
  }
  diffusion::Denoiser& denoiser = worker.denoiser();
  denoiser.setContexts(contexts);
  const auto branch = stateBranch(denoiser, contexts);
  GuidedBatch guided(model_.normalizer, objectives);
  const auto samples = sampler_.sample(denoiser, *branch, requests, &guided);
  const auto candidates = static_cast<std::size_t>(guidance_.candidates);
  for (std::size_t i = 0; i < situations.size(); ++i)
    choose(*situations[i], samples, i * candidates);
}

Rollout DiffusionPlanner::drivenBy(const Situation& situation, const Rollout& plan) const {
  Rollout driven = plan;
  dynamics::makeExecutable(driven);
  exact_.rollOut(situation.task->vehicle->state.speed, driven);
  return driven;
}

void DiffusionPlanner::choose(Situation& situation, const std::vector<SampledTrajectory>& samples,
                              std::size_t first) const {
  std::vector<Rollout> plans;
  std::vector<guidance::Score> scores;
  const Eigen::Index rows = std::lround(guidance_.road_horizon / traffic::kRolloutStep);
  for (std::size_t i = 0; i < situation.objectives.size(); ++i) {
    plans.push_back(model_.normalizer.denormalize(samples[first + i].clean));
    scores.push_back(situation.objectives[i]->score(plans.back()));
    scores.back().off_road =
        guidance::rowsOffRoad(situation.scene, drivenBy(situation, plans.back()), rows);
  }
  const std::size_t chosen = choosePlan(plans, scores, situation.previous, options_.hysteresis);
  situation.plan = plans[chosen];
  situation.report = situation.objectives[chosen]->report(situation.plan);
  situation.report.candidates = guidance_.candidates;
  situation.report.chosen = static_cast<std::int64_t>(chosen);
  const SampledTrajectory& sample = samples[first + chosen];
  if (sample.guided_steps > 0) {
    situation.report.trust_region_share =
        static_cast<double>(sample.trust_region_hits) / static_cast<double>(sample.guided_steps);
  }
}

planning::PlannedAction DiffusionPlanner::actionOf(const Situation& situation) const {
  const planning::PlanningTask& task = *situation.task;
  const traffic::VehicleState& start = task.vehicle->state;
  const Rollout driven = drivenBy(situation, situation.plan);
  planning::PlannedAction planned{task.slot, task.vehicle->id, {}, {}};
  planned.guidance = situation.report;
  for (Eigen::Index row = 0; row < driven.rows(); ++row) {
    const double speed = row == 0 ? start.speed : driven(row - 1, traffic::kRolloutSpeed);
    const traffic::ControlAction action =
        exact_.commanded(speed, dynamics::executableAction(situation.plan, row));
    traffic::VehicleState state = start;
    state.position = start.pose().toMap(situation.plan.row(row).head<2>().transpose());
    state.heading = core::wrapAngle(start.heading + situation.plan(row, traffic::kRolloutHeading));
    state.speed = std::max(0.0, situation.plan(row, traffic::kRolloutSpeed));
    planned.rollout.push_back({state, action});
  }
  planned.action = planned.rollout.front().action;
  planned.state_mismatch =
      (driven.leftCols<2>() - situation.plan.leftCols<2>()).rowwise().norm().maxCoeff();
  return planned;
}

void DiffusionPlanner::followEgo(const traffic::TrafficSnapshot& snapshot) {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr || context_.ego_route == nullptr || context_.ego_route->empty()) return;
  if (!planning::isFinite(ego->state)) return;
  constexpr double kFastest = 40.0;  // [m/s]
  const auto skipped = static_cast<double>(snapshot.tick - std::min(snapshot.tick, ego_tick_));
  ego_follower_.update(*context_.ego_route, ego->state.position,
                       kFastest * skipped * context_.simulation_step);
  ego_tick_ = snapshot.tick;
}

void DiffusionPlanner::rememberOnly(const std::vector<planning::PlanningTask>& tasks) {
  std::map<std::string, std::unique_ptr<Memory>> kept;
  for (const planning::PlanningTask& task : tasks) {
    std::unique_ptr<Memory>& known = memories_[task.vehicle->id];
    kept[task.vehicle->id] = known ? std::move(known) : std::make_unique<Memory>();
  }
  memories_ = std::move(kept);
}

/// The chosen plan becomes the vehicle's action, unless it cannot be executed.
void DiffusionPlanner::conclude(std::uint64_t tick, const Situation& situation,
                                planning::PlannedAction& planned) const {
  if (!situation.plan.allFinite()) {
    planned = planning::failSafeAction(*situation.task, "the sampled plan is not finite");
    situation.memory->plan.reset();
    return;
  }
  planned = actionOf(situation);
  const planning::PlanningTask& task = *situation.task;
  situation.memory->plan.emplace(situation.plan, tick, task.vehicle->state, task.route);
}

std::vector<planning::PlannedAction> DiffusionPlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  followEgo(snapshot);
  rememberOnly(tasks);
  std::vector<planning::PlannedAction> actions;
  std::vector<std::pair<const planning::PlanningTask*, Memory*>> seen;
  for (const planning::PlanningTask& task : tasks) {
    Memory& memory = *memories_[task.vehicle->id];
    const auto fault = faultOf(task, snapshot.tick, memory);
    actions.push_back(planning::failSafeAction(task, fault.value_or("")));
    if (fault) {
      memory.plan.reset();
    } else {
      seen.emplace_back(&task, &memory);
    }
  }
  encodeImages(seen);
  rememberFeatures(snapshot.tick, seen);
  setCompanions(seen);
  std::vector<std::unique_ptr<Situation>> situations(tasks.size());
  std::vector<Situation*> cold;
  std::vector<Situation*> warm;
  for (const auto& [task, memory] : seen) {
    auto& situation = situations[static_cast<std::size_t>(task - tasks.data())];
    situation = situationOf(snapshot, *task, *memory);
    (situation->warm ? warm : cold).push_back(situation.get());
  }
  solveByWorkers(snapshot.tick, cold);
  solveByWorkers(snapshot.tick, warm);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (situations[i]) conclude(snapshot.tick, *situations[i], actions[i]);
  }
  return actions;
}

}  // namespace cdiff::planners
