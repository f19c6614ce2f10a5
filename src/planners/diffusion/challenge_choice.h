// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "e2e_cdiff/planning/challenge.h"
#include "planners/diffusion/plan_choice.h"

namespace cdiff::planners {

/// The choice of mode challenging (e2e_cdiff/planning/challenge.h) among the sampled plans, the
/// plan of the last decision with a braking tail, and braking at once. References must outlive it.
class ChallengeChoice {
 public:
  ChallengeChoice(const guidance::GuidanceOptions& guidance,
                  const planning::PlanningContext& context, const PlanChoice& choice,
                  const dynamics::ActionRollout& exact)
      : guidance_(guidance),
        rows_(context.decision_period / traffic::kRolloutStep),
        choice_(choice),
        exact_(exact),
        challenge_(context, guidance.challenge) {}

  /// Starts a decision.
  void startDecision(const traffic::TrafficSnapshot& snapshot) {
    challenge_.startDecision(snapshot);
  }
  /// For one vehicle after the other, in slot order.
  ChosenPlan choose(std::uint64_t tick, const PlannedVehicle& vehicle,
                    const DiffusionSituation& situation, PlanCandidates candidates);

 private:
  std::optional<traffic::Rollout> keptPlan(std::uint64_t tick, const PlannedVehicle& vehicle) const;
  std::vector<std::size_t> addRetimed(const DiffusionSituation& situation, double speed,
                                      PlanCandidates& candidates) const;
  static void add(const traffic::Rollout& rollout, double score, PlanCandidates& candidates);

  const guidance::GuidanceOptions& guidance_;
  double rows_;  ///< of a decision period
  const PlanChoice& choice_;
  const dynamics::ActionRollout& exact_;
  planning::Challenge challenge_;
};

}  // namespace cdiff::planners
