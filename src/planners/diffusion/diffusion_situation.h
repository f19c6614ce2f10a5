// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diffusion/model.h"
#include "diffusion/sampler.h"
#include "dynamics/action_rollout.h"
#include "e2e_cdiff/guidance/guidance_options.h"
#include "e2e_cdiff/guidance/objective.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "guidance/right_of_way.h"
#include "guidance/total_objective.h"
#include "planners/diffusion/diffusion_memory.h"
#include "planners/diffusion/diffusion_options.h"
#include "planning/route_follower.h"

namespace cdiff::planners {

/// A scene whose other vehicle is expected farther ahead than it will be: what plans aim at in mode
/// challenging, so that they come before the ego and not into its flank.
struct AimedScene {
  AimedScene(const guidance::GuidanceScene& original, const guidance::OtherMotion& other,
             double ahead);
  AimedScene(const AimedScene&) = delete;  // its scene refers to its motion
  AimedScene& operator=(const AimedScene&) = delete;

  guidance::OtherMotion motion;
  guidance::GuidanceScene scene;
};

/// What the network and the objectives are given for one vehicle at a decision.
struct DiffusionSituation {
  DiffusionSituation() = default;
  DiffusionSituation(const DiffusionSituation&) = delete;  // its parts refer to each other
  DiffusionSituation& operator=(const DiffusionSituation&) = delete;

  const planning::PlanningTask* task = nullptr;
  diffusion::Context context;
  guidance::GuidanceScene scene;
  guidance::OtherMotion other;                    ///< whom collision objectives are about
  std::vector<std::unique_ptr<AimedScene>> aims;  ///< of mode challenging, by candidate in turn
  std::optional<traffic::Rollout> previous;       ///< last plan as seen from here, metric
  std::optional<diffusion::Trajectory> warm;      ///< the same, normalized, where it fits
  std::vector<std::unique_ptr<guidance::TotalObjective>> objectives;  ///< one per candidate
};

/// A vehicle that is planned at a decision, and what is remembered of it.
struct PlannedVehicle {
  const planning::PlanningTask* task = nullptr;
  DiffusionMemory* memory = nullptr;
};

/// Makes the situations of the vehicles of a decision.
///  - Collision objectives are about the ego, for a CBV (forecast along its route), and about the
///    nearest other vehicle, for the ego.
///  - Attackers are not given their route (DiffusionOptions::conditioningUnder); whoever is not
///    gets neither the image before nor the target speed of a model that takes them, so that
///    `image` is the paper's single image.
/// References must outlive it; the guidance may change between decisions.
class SituationMaker {
 public:
  /// `exact`: how the vehicles execute a plan.
  SituationMaker(const DiffusionOptions& options, const guidance::GuidanceOptions& guidance,
                 const dynamics::BicycleModelOptions& vehicle,
                 const planning::PlanningContext& context, const diffusion::Model& model,
                 const dynamics::ActionRollout& exact);

  /// Whether the network is given more than the image.
  bool conditionsOnRoute() const { return options_.conditioningUnder(guidance_) == "image_route"; }
  /// Ticks between a decision's image and the one before that the model takes; 0: it takes none.
  std::uint64_t ticksToPrevious() const;
  /// Starts a decision: moves the ego and the planned vehicles along their routes to where they are
  /// now. Planned vehicles that are given their routes are forecast there, for each other.
  void startDecision(const traffic::TrafficSnapshot& snapshot,
                     const std::vector<PlannedVehicle>& planned);
  /// That of one of the planned vehicles, in the snapshot of the decision. `vehicle` must outlive
  /// it.
  std::unique_ptr<DiffusionSituation> make(const traffic::TrafficSnapshot& snapshot,
                                           const PlannedVehicle& vehicle) const;

 private:
  void followEgo(const traffic::TrafficSnapshot& snapshot);
  void setRoute(const PlannedVehicle& vehicle, DiffusionSituation& situation) const;
  /// Gives the network the image before and the target speed, where it takes them.
  void addMotion(std::uint64_t tick, const DiffusionMemory& memory,
                 DiffusionSituation& situation) const;
  /// A vehicle around a planned one, forecast along its route where this planner drives it there.
  guidance::OtherMotion motionOf(const traffic::Vehicle& near,
                                 const traffic::Vehicle& planned) const;
  void setOther(const traffic::TrafficSnapshot& snapshot, DiffusionSituation& situation) const;
  void addObjectives(DiffusionSituation& situation) const;
  void setWarmStart(std::uint64_t tick, const std::optional<LastPlan>& last,
                    DiffusionSituation& situation) const;
  /// Rows of a forecast.
  std::size_t horizon() const { return static_cast<std::size_t>(model_.architecture.horizon); }

  const DiffusionOptions& options_;
  const guidance::GuidanceOptions& guidance_;
  dynamics::BicycleModelOptions vehicle_;
  planning::PlanningContext context_;
  const diffusion::Model& model_;
  const dynamics::ActionRollout& exact_;
  planning::EgoFollower ego_follower_;
  std::map<std::string, guidance::OtherMotion> companions_;  ///< of this decision, by vehicle
  guidance::RightOfWay right_of_way_;                        ///< among them
};

}  // namespace cdiff::planners
