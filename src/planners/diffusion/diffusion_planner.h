// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diffusion/model.h"
#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/network/image_encoder.h"
#include "diffusion/sampler.h"
#include "e2e_cdiff/guidance/guidance_options.h"
#include "e2e_cdiff/guidance/objective.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "guidance/right_of_way.h"
#include "planners/diffusion/diffusion_options.h"
#include "planners/diffusion/image_watch.h"
#include "planning/route_follower.h"

namespace cdiff::planners {

/// Encoder and denoiser of a model for one thread.
class Worker {
 public:
  /// `scaled_route`: the denoiser mixes predictions with and without the route (route_scale).
  Worker(const DiffusionOptions& options, const diffusion::Model& model, bool scaled_route);

  diffusion::ImageEncoder& encoder() { return encoder_; }
  diffusion::Denoiser& denoiser();

 private:
  diffusion::ImageEncoder encoder_;
  diffusion::CpuDenoiser denoiser_;
  std::unique_ptr<diffusion::CpuDenoiser> routeless_;       ///< where route_scale is not 1
  std::unique_ptr<diffusion::RouteScaledDenoiser> scaled_;  ///< likewise
};

/// The guided diffusion planner (paper III): front-view image, own speed and route in; a rollout of
/// future states and throttle, steer and brake out, of which the first action drives. The vehicles
/// of a decision form one batch, or one for each of several threads, with the same bytes.
///
/// Choices where the paper leaves them open:
///  - the image is encoded once per decision, the denoiser runs on its features;
///  - collision objectives are about the ego, for a CBV (forecast along its route), and about the
///    nearest other vehicle, for the ego;
///  - attackers are not given their route (DiffusionOptions::conditioningUnder); whoever is not
///    gets neither the image before nor the target speed of a model that takes them, so that
///    `image` is the paper's single image;
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
  ~DiffusionPlanner() override;

  /// A vehicle with a NaN state, without a usable image, or without a route where one is asked for
  /// gets the fail-safe action and a fault that names what is wrong; the others drive on.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;
  const diffusion::Model& model() const { return model_; }

 private:
  struct Memory;
  struct Situation;

  void followEgo(const traffic::TrafficSnapshot& snapshot);
  void rememberOnly(const std::vector<planning::PlanningTask>& tasks);
  std::optional<std::string> faultOf(const planning::PlanningTask& task, std::uint64_t tick,
                                     Memory& memory);
  /// Calls `part` for every worker with the range of `count` items that is its share, each in a
  /// thread of its own.
  using WorkerPart = std::function<void(Worker& worker, std::size_t begin, std::size_t end)>;
  void forEachWorker(std::size_t count, const WorkerPart& part);
  void encodeImages(const std::vector<std::pair<const planning::PlanningTask*, Memory*>>& seen);
  void rememberFeatures(
      std::uint64_t tick,
      const std::vector<std::pair<const planning::PlanningTask*, Memory*>>& seen) const;
  /// Ticks between a decision's image and the one before that the model takes; 0: it takes none.
  std::uint64_t ticksToPrevious() const;
  /// Gives the network the image before and the target speed, where it takes them.
  void addMotion(std::uint64_t tick, Situation& situation) const;
  std::unique_ptr<Situation> situationOf(const traffic::TrafficSnapshot& snapshot,
                                         const planning::PlanningTask& task, Memory& memory);
  /// Moves the vehicles that this planner drives along their routes to where they are now, and
  /// forecasts them there, for each other, where they are given their routes.
  void setCompanions(const std::vector<std::pair<const planning::PlanningTask*, Memory*>>& seen);
  /// A vehicle around a planned one, forecast along its route where this planner drives it there.
  guidance::OtherMotion motionOf(const traffic::Vehicle& near,
                                 const traffic::Vehicle& planned) const;
  void setOther(const traffic::TrafficSnapshot& snapshot, Situation& situation);
  void setWarmStart(std::uint64_t tick, Situation& situation) const;
  std::unique_ptr<diffusion::StateBranch> stateBranch(
      diffusion::Denoiser& denoiser, const std::vector<diffusion::Context>& contexts) const;
  void solve(std::uint64_t tick, Worker& worker, const std::vector<Situation*>& situations);
  void solveByWorkers(std::uint64_t tick, const std::vector<Situation*>& situations);
  void choose(Situation& situation, const std::vector<diffusion::SampledTrajectory>& samples,
              std::size_t first) const;
  /// What the vehicle does when a plan's actions are executed to its end (body frame, [T, 7]).
  traffic::Rollout drivenBy(const Situation& situation, const traffic::Rollout& plan) const;
  planning::PlannedAction actionOf(const Situation& situation) const;
  void conclude(std::uint64_t tick, const Situation& situation,
                planning::PlannedAction& planned) const;

  DiffusionOptions options_;
  guidance::GuidanceOptions guidance_;
  bool conditions_on_route_;  ///< whether the network is given more than the image
  dynamics::BicycleModelOptions vehicle_;
  planning::PlanningContext context_;
  diffusion::Model model_;
  diffusion::NoiseSchedule schedule_;
  std::vector<std::unique_ptr<Worker>> workers_;  ///< one a thread
  diffusion::Sampler sampler_;
  dynamics::ActionRollout exact_;
  planning::RouteFollower ego_follower_;
  std::uint64_t ego_tick_ = 0;                               ///< at which ego_follower_ was moved
  std::map<std::string, std::unique_ptr<Memory>> memories_;  ///< by vehicle
  std::map<std::string, guidance::OtherMotion> companions_;  ///< of this tick, by vehicle
  guidance::RightOfWay right_of_way_;                        ///< among them
};

}  // namespace cdiff::planners
