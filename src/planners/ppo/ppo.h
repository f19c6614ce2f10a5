// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <set>
#include <string>
#include <vector>

#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/pdm_lite/pdm_lite.h"
#include "planners/ppo/ppo_network.h"
#include "planning/route_follower.h"

namespace cdiff::planners {

/// Options of the planner `ppo`.
struct PpoOptions : WeightOptions {
  std::string after_goal = "route";  ///< route | goal: what a CBV does once it has reached its goal

  PpoOptions() : WeightOptions{kPpo.planner} {}
  void describe(core::OptionsVisitor& visitor);
};

/// The PPO baseline of RIFT and FREA as a planner of CBVs: action tanh(mean) of a small network
/// that sees the CBV, the ego, the nearest vehicle and a goal on the ego's route (ppo_rules.h),
/// trained in this package's simulator (docs/ppo.md).
///
/// RIFT gives a CBV that has reached its goal back to the traffic manager. Here it stays a CBV:
/// with after_goal "route" PDM-Lite drives it on along its conflict-aware route from then on, with
/// "goal" the network goes on toward the goal, which moves with the ego.
class Ppo : public planning::Planner {
 public:
  /// Throws InputError for weights that are missing or of another planner.
  Ppo(const PpoOptions& options, const PdmLiteOptions& on_route,
      const dynamics::BicycleModelOptions& vehicle, const planning::PlanningContext& context);

  /// A vehicle whose observation is not finite, or that has no ego to look at, gets the fail-safe
  /// action and a fault. Deterministic; remembers how far the ego has come and, as long as it is
  /// among the tasks, who has reached the goal.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  /// Why no vehicle can be driven at this snapshot; empty where they can.
  std::string faultOf(const traffic::Vehicle* ego) const;
  planning::PlannedAction towardGoal(const traffic::TrafficSnapshot& snapshot,
                                     const planning::PlanningTask& task, const PpoGoal& goal);
  void forgetOthers(const std::vector<planning::PlanningTask>& tasks);
  void driveOn(const traffic::TrafficSnapshot& snapshot,
               const std::vector<planning::PlanningTask>& tasks,
               std::vector<planning::PlannedAction>& actions);

  PpoOptions options_;
  PpoActor actor_;
  PdmLite on_route_;
  const map::Route* ego_route_;
  planning::EgoFollower ego_;
  double simulation_step_;         ///< [s]
  std::set<std::string> arrived_;  ///< ids of those of the last call that have reached their goal
};

}  // namespace cdiff::planners
