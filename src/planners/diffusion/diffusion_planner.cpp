// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/stage_times.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "planners/diffusion/guided_batch.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {

namespace {

using traffic::Rollout;

diffusion::SamplerOptions samplerOptions(const DiffusionOptions& options,
                                         const guidance::GuidanceOptions& guidance) {
  diffusion::SamplerOptions sampler = options.sampler;
  sampler.trust_region = guidance.trust_region;
  sampler.noise_correlation = guidance.noise_correlation;
  return sampler;
}

/// Throws InputError for a conditioning that gives vehicles a route, for a choice of further inputs
/// and for a current state, which the model does not take.
void requireInputs(const DiffusionOptions& options, const diffusion::Model& model) {
  const bool moves = model.architecture.takesPrevious() || model.architecture.takesTarget();
  if (options.motion != "all" && !moves)
    throw core::InputError("key 'diffusion.motion' is '" + options.motion + "', and model '" +
                           model.name +
                           "' takes neither the image before nor the target speed; "
                           "expected 'all'");
  const std::string trained = model.architecture.pinsCurrentState() ? "pinned" : "none";
  if (options.current_state != trained)
    throw core::InputError("key 'diffusion.current_state' is '" + options.current_state +
                           "', and the weights of model '" + model.name + "' were trained with '" +
                           trained + "'; expected '" + trained + "'");
  if (model.architecture.takesRoute() || options.conditioning == "image") return;
  throw core::InputError("key 'diffusion.conditioning' is '" + options.conditioning +
                         "', and model '" + model.name + "' takes no route; expected 'image'");
}

/// The model, after a check of the options against each other and against it.
std::shared_ptr<const diffusion::Model> loadChecked(const DiffusionOptions& options,
                                                    const guidance::GuidanceOptions& guidance,
                                                    const std::string& guidance_group) {
  std::shared_ptr<const diffusion::Model> model = diffusion::sharedModel(options.model);
  options.validate();
  guidance.validate(guidance_group);
  requireInputs(options, *model);
  return model;
}

}  // namespace

DiffusionPlanner::DiffusionPlanner(const DiffusionOptions& options,
                                   const guidance::GuidanceOptions& guidance,
                                   const dynamics::BicycleModelOptions& vehicle,
                                   const planning::PlanningContext& context,
                                   const std::string& guidance_group)
    : options_(options),
      guidance_(guidance),
      guidance_group_(guidance_group),
      vehicle_(vehicle),
      context_(context),
      model_(loadChecked(options, guidance, guidance_group)),
      schedule_(static_cast<int>(model_->architecture.diffusion_steps)),
      sampler_(samplerOptions(options, guidance), schedule_, model_->spread,
               core::RandomStream(context.seed, "diffusion")),
      exact_(vehicle, dynamics::throttleResponse(options.response)),
      situations_(options_, guidance_, vehicle, context, *model_, exact_),
      choice_(guidance_, options.hysteresis, model_->normalizer, exact_),
      workers_(options, *model_, options.conditioning != "image" && options.route_scale != 1.0) {
  requireWindows(guidance_);
  prepareChallenge();
}

void DiffusionPlanner::requireWindows(const guidance::GuidanceOptions& guidance) const {
  if (options_.sampler.mode == "unguided") return;
  guidance.validateWindows(schedule_.steps(), sampler_.visitedSteps(false), guidance_group_);
}

void DiffusionPlanner::prepareChallenge() {
  challenge_.reset();
  if (guidance_.challenge != "off")
    challenge_ = std::make_unique<ChallengeChoice>(guidance_, context_, choice_, exact_);
}

void DiffusionPlanner::setGuidance(const guidance::GuidanceOptions& guidance) {
  guidance.validate(guidance_group_);
  requireWindows(guidance);
  const bool other_challenge = guidance.challenge != guidance_.challenge;
  guidance_ = guidance;
  sampler_.setGuidance(guidance.trust_region, guidance.noise_correlation);
  if (other_challenge) prepareChallenge();
}

std::optional<std::string> DiffusionPlanner::faultOf(const planning::PlanningTask& task,
                                                     std::uint64_t tick,
                                                     DiffusionMemory& memory) const {
  if (!planning::isFinite(task.vehicle->state)) return "its state is not finite";
  const diffusion::Architecture& sizes = model_->architecture;
  const ImageExpectation expectation{static_cast<int>(sizes.image_width),
                                     static_cast<int>(sizes.image_height),
                                     options_.frozen_image_time, context_.simulation_step};
  const traffic::CameraImage* image = task.views.find(rendering::kFrontCamera);
  if (auto fault = memory.watch.fault(expectation, image, task.vehicle->state, tick)) return fault;
  const bool has_route = task.route != nullptr && !task.route->empty();
  if (!has_route && situations_.conditionsOnRoute()) return "it has no route";
  return std::nullopt;
}

/// Encodes each image unless it is the one of the last decision, as before a standing vehicle.
void DiffusionPlanner::encodeImages(std::uint64_t tick,
                                    const std::vector<PlannedVehicle>& vehicles) {
  const core::TimedStage stage("encoding");
  std::vector<PlannedVehicle> changed;
  for (const PlannedVehicle& vehicle : vehicles) {
    if (vehicle.memory->takeImage()) changed.push_back(vehicle);
  }
  workers_.forEach(changed.size(), [&](Worker& worker, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [task, memory] = changed[i];
      memory->features = worker.encoder().encode(*task->views.find(rendering::kFrontCamera));
    }
  });
  for (const PlannedVehicle& vehicle : vehicles)
    vehicle.memory->keepFeatures(tick, situations_.ticksToPrevious());
}

std::unique_ptr<diffusion::StateBranch> DiffusionPlanner::stateBranch(
    diffusion::Denoiser& denoiser, const std::vector<diffusion::Context>& contexts) const {
  if (options_.state_branch == "learned")
    return std::make_unique<diffusion::LearnedStateBranch>(denoiser);
  std::vector<double> speeds;
  for (const diffusion::Context& context : contexts) speeds.push_back(context.speed);
  return std::make_unique<diffusion::ExactStateBranch>(
      vehicle_, model_->normalizer, speeds, dynamics::throttleResponse(options_.response));
}

/// In parts of few samples, whose values stay in the cache from layer to layer.
void DiffusionPlanner::solve(std::uint64_t tick, const std::vector<Solution*>& solutions) {
  constexpr std::int64_t kSamples = 16;
  const auto together =
      static_cast<std::size_t>(std::max<std::int64_t>(1, kSamples / guidance_.candidates));
  workers_.forEach(solutions.size(), [&](Worker& worker, std::size_t begin, std::size_t end) {
    for (std::size_t first = begin; first < end; first += together) {
      const std::size_t last = std::min(end, first + together);
      solvePart(tick, worker,
                {solutions.begin() + static_cast<long>(first),
                 solutions.begin() + static_cast<long>(last)});
    }
  });
}

void DiffusionPlanner::solvePart(std::uint64_t tick, Worker& worker,
                                 const std::vector<Solution*>& solutions) const {
  std::vector<diffusion::Context> contexts;
  std::vector<diffusion::SampleRequest> requests;
  std::vector<guidance::TotalObjective*> objectives;
  for (const Solution* solution : solutions) {
    const DiffusionSituation& situation = *solution->situation;
    for (std::size_t candidate = 0; candidate < situation.objectives.size(); ++candidate) {
      contexts.push_back(situation.context);
      diffusion::SampleRequest request;
      request.key = {core::hashText(situation.task->vehicle->id), static_cast<std::uint32_t>(tick),
                     0};
      request.candidate = static_cast<std::uint32_t>(candidate);
      request.warm = situation.warm ? &*situation.warm : nullptr;
      requests.push_back(request);
      objectives.push_back(situation.objectives[candidate].get());
    }
  }
  diffusion::Denoiser& denoiser = worker.denoiser(situations_.conditionsOnRoute());
  denoiser.setContexts(contexts);
  const auto branch = stateBranch(denoiser, contexts);
  GuidedBatch guided(model_->normalizer, objectives);
  const auto samples = sampler_.sample(denoiser, *branch, requests, &guided);
  const auto candidates = static_cast<std::size_t>(guidance_.candidates);
  for (std::size_t i = 0; i < solutions.size(); ++i) {
    const DiffusionSituation& situation = *solutions[i]->situation;
    if (challenge_) {
      solutions[i]->candidates = choice_.candidatesOf(samples, i * candidates, situation);
    } else {
      solutions[i]->chosen = choice_.among(samples, i * candidates, situation);
    }
  }
}

namespace {

/// The plans that were weighed, in the map frame; nothing where there was no choice.
std::vector<planning::PlannedCandidate> plannedCandidates(const geometry::Pose2d& pose,
                                                          const ChosenPlan& chosen) {
  const auto stride =
      static_cast<Eigen::Index>(std::lround(planning::kCandidateStep / traffic::kRolloutStep));
  const auto& plans = chosen.weighed.plans;
  const auto& scores = chosen.weighed.scores;
  std::vector<planning::PlannedCandidate> candidates;
  for (std::size_t i = 0; plans.size() > 1 && i < plans.size(); ++i) {
    if (!plans[i].allFinite()) continue;
    planning::PlannedCandidate& candidate = candidates.emplace_back();
    candidate.score = -scores[i].value;
    candidate.chosen = static_cast<std::int64_t>(i) == chosen.report.chosen;
    for (Eigen::Index row = stride - 1; row < plans[i].rows(); row += stride)
      candidate.places.push_back(pose.toMap(plans[i].row(row).head<2>().transpose()));
  }
  return candidates;
}

}  // namespace

planning::PlannedAction DiffusionPlanner::actionOf(const planning::PlanningTask& task,
                                                   const ChosenPlan& chosen) const {
  const traffic::VehicleState& start = task.vehicle->state;
  const traffic::Rollout& plan = chosen.plan;
  const traffic::Rollout& driven = chosen.driven;
  planning::PlannedAction planned{task.slot, task.vehicle->id, {}, {}};
  planned.guidance = chosen.report;
  planned.candidates = plannedCandidates(start.pose(), chosen);
  for (Eigen::Index row = 0; row < driven.rows(); ++row) {
    const double speed = row == 0 ? start.speed : driven(row - 1, traffic::kRolloutSpeed);
    const traffic::ControlAction action =
        exact_.commanded(speed, dynamics::executableAction(plan, row));
    traffic::VehicleState state = start;
    state.position = start.pose().toMap(plan.row(row).head<2>().transpose());
    state.heading = core::wrapAngle(start.heading + plan(row, traffic::kRolloutHeading));
    state.speed = std::max(0.0, plan(row, traffic::kRolloutSpeed));
    planned.rollout.push_back({state, action});
  }
  planned.action = planned.rollout.front().action;
  planned.state_mismatch = (driven.leftCols<2>() - plan.leftCols<2>()).rowwise().norm().maxCoeff();
  return planned;
}

/// The chosen plan becomes the vehicle's action, unless it cannot be executed.
planning::PlannedAction DiffusionPlanner::conclude(std::uint64_t tick,
                                                   const PlannedVehicle& vehicle,
                                                   const ChosenPlan& chosen) const {
  const auto& [task, memory] = vehicle;
  if (!chosen.plan.allFinite()) {
    memory->plan.reset();
    return planning::failSafeAction(*task, "the sampled plan is not finite");
  }
  memory->plan.emplace(chosen.plan, tick, task->vehicle->state, task->route);
  return actionOf(*task, chosen);
}

std::vector<PlannedVehicle> DiffusionPlanner::look(std::uint64_t tick,
                                                   const std::vector<planning::PlanningTask>& tasks,
                                                   std::vector<planning::PlannedAction>& actions) {
  std::vector<PlannedVehicle> vehicles;
  for (const planning::PlanningTask& task : tasks) {
    DiffusionMemory& memory = memories_.keep(task.vehicle->id, [] { return DiffusionMemory(); });
    const auto fault = faultOf(task, tick, memory);
    actions.push_back(planning::failSafeAction(task, fault.value_or("")));
    if (fault) {
      memory.plan.reset();
    } else {
      vehicles.push_back({&task, &memory});
    }
  }
  memories_.forgetOthers();
  encodeImages(tick, vehicles);
  return vehicles;
}

std::vector<planning::PlannedAction> DiffusionPlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions;
  const std::vector<PlannedVehicle> vehicles = look(snapshot.tick, tasks, actions);
  situations_.startDecision(snapshot, vehicles);
  std::vector<Solution> solutions(vehicles.size());
  std::vector<Solution*> cold;
  std::vector<Solution*> warm;
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    solutions[i].situation = situations_.make(snapshot, vehicles[i]);
    (solutions[i].situation->warm ? warm : cold).push_back(&solutions[i]);
  }
  solve(snapshot.tick, cold);
  solve(snapshot.tick, warm);
  if (challenge_) challenge_->startDecision(snapshot);
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    Solution& solution = solutions[i];
    if (challenge_) {
      solution.chosen = challenge_->choose(snapshot.tick, vehicles[i], *solution.situation,
                                           std::move(solution.candidates));
    }
    const auto index = static_cast<std::size_t>(vehicles[i].task - tasks.data());
    actions[index] = conclude(snapshot.tick, vehicles[i], solution.chosen);
  }
  return actions;
}

}  // namespace cdiff::planners
