// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diffusion/model.h"
#include "diffusion/sampler.h"
#include "e2e_cdiff/guidance/guidance_options.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/diffusion/challenge_choice.h"
#include "planners/diffusion/diffusion_memory.h"
#include "planners/diffusion/diffusion_options.h"
#include "planners/diffusion/diffusion_situation.h"
#include "planners/diffusion/diffusion_workers.h"
#include "planners/diffusion/plan_choice.h"
#include "planning/vehicle_memory.h"

namespace cdiff::planners {

/// The guided diffusion planner (paper III): front-view image, own speed and route in; a rollout of
/// future states and throttle, steer and brake out, of which the first action drives. The vehicles
/// of a decision form one batch, or one for each of several threads, with the same bytes.
///
/// Choices where the paper leaves them open:
///  - the image is encoded once per decision, the denoiser runs on its features;
///  - whom collision objectives are about and who is given its route: SituationMaker;
///  - actions are clamped to their range, a brake below 0.05 counts as none, and of throttle and
///    brake the larger one acts; with response `monotone` a throttle that would slow the vehicle is
///    commanded as 0 (dynamics::commandedAction);
///  - of several candidates the one with the lowest weighted objective drives, unless the one
///    nearest to the previous plan is no worse by `hysteresis`; those that keep on the road as long
///    as GuidanceOptions::road_horizon asks come before that.
class DiffusionPlanner : public planning::Planner {
 public:
  /// Loads the model. Throws InputError for a bad model or bad options; `guidance_group` is put
  /// before the keys of guidance that it names.
  DiffusionPlanner(const DiffusionOptions& options, const guidance::GuidanceOptions& guidance,
                   const dynamics::BicycleModelOptions& vehicle,
                   const planning::PlanningContext& context,
                   const std::string& guidance_group = "guidance.");

  /// A vehicle with a NaN state, without a usable image, or without a route where one is asked for
  /// gets the fail-safe action and a fault that names what is wrong; the others drive on.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;
  void setGuidance(const guidance::GuidanceOptions& guidance) override;
  const diffusion::Model& model() const { return *model_; }

 private:
  /// A situation, and what is driven in it.
  struct Solution {
    std::unique_ptr<DiffusionSituation> situation;
    ChosenPlan chosen;
    PlanCandidates candidates;  ///< in mode challenging, where `chosen` comes after all are sampled
  };

  std::optional<std::string> faultOf(const planning::PlanningTask& task, std::uint64_t tick,
                                     DiffusionMemory& memory) const;
  /// The vehicles that can be planned, with their images encoded; `actions` become fail-safe ones,
  /// with a fault for the others.
  std::vector<PlannedVehicle> look(std::uint64_t tick,
                                   const std::vector<planning::PlanningTask>& tasks,
                                   std::vector<planning::PlannedAction>& actions);
  void encodeImages(std::uint64_t tick, const std::vector<PlannedVehicle>& vehicles);
  /// Throws InputError for guidance that the model or the sampler cannot follow.
  void requireWindows(const guidance::GuidanceOptions& guidance) const;
  /// Starts the choice of mode challenging anew, where guidance asks for it.
  void prepareChallenge();
  std::unique_ptr<diffusion::StateBranch> stateBranch(
      diffusion::Denoiser& denoiser, const std::vector<diffusion::Context>& contexts) const;
  /// Samples the candidates of all situations, each worker its share, and chooses among them. All
  /// start warm, or all cold.
  void solve(std::uint64_t tick, const std::vector<Solution*>& solutions);
  void solvePart(std::uint64_t tick, Worker& worker, const std::vector<Solution*>& solutions) const;
  planning::PlannedAction actionOf(const planning::PlanningTask& task,
                                   const ChosenPlan& chosen) const;
  planning::PlannedAction conclude(std::uint64_t tick, const PlannedVehicle& vehicle,
                                   const ChosenPlan& chosen) const;

  DiffusionOptions options_;
  guidance::GuidanceOptions guidance_;
  std::string guidance_group_;
  dynamics::BicycleModelOptions vehicle_;
  planning::PlanningContext context_;
  std::shared_ptr<const diffusion::Model> model_;
  diffusion::NoiseSchedule schedule_;
  diffusion::Sampler sampler_;
  dynamics::ActionRollout exact_;
  SituationMaker situations_;
  PlanChoice choice_;
  DiffusionWorkers workers_;
  std::unique_ptr<ChallengeChoice> challenge_;  ///< null but in mode challenging
  planning::VehicleMemory<DiffusionMemory> memories_;
};

}  // namespace cdiff::planners
