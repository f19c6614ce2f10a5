// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "diffusion/normalizer.h"
#include "diffusion/sampler.h"
#include "dynamics/action_rollout.h"
#include "e2e_cdiff/guidance/guidance_options.h"
#include "guidance/total_objective.h"
#include "planners/diffusion/diffusion_situation.h"

namespace cdiff::planners {

// Which of several sampled plans (rollouts [T, 7], body frame, SI units) is driven: the one of the
// lowest score; or, so that a vehicle does not waver between plans that are about equally good, the
// one nearest to the last plan while it is no worse by more than a share.

/// Index into `plans`. `previous` is the last plan as seen from here. Plans that are not finite are
/// not chosen unless none is.
std::size_t choosePlan(const std::vector<traffic::Rollout>& plans,
                       const std::vector<guidance::Score>& scores,
                       const std::optional<traffic::Rollout>& previous, double hysteresis);

/// The plans of a vehicle that are chosen among, one entry per sample.
struct PlanCandidates {
  std::vector<traffic::Rollout> plans;   ///< as sampled
  std::vector<traffic::Rollout> driven;  ///< what the vehicle does
  std::vector<guidance::Score> scores;
  std::vector<double> trust_region_shares;  ///< of the guided denoising steps of each
};

/// The plan that a vehicle drives (rollouts [T, 7], body frame, SI units).
struct ChosenPlan {
  traffic::Rollout plan;    ///< as it was sampled
  traffic::Rollout driven;  ///< what the vehicle does when the plan's actions are executed
  guidance::GuidanceReport report;
  PlanCandidates weighed{};  ///< what it was chosen from by its score; empty in mode challenging
};

/// Chooses among the candidates of a vehicle by its objectives, those first that keep on the road
/// as long as GuidanceOptions::road_horizon asks. References must outlive it.
class PlanChoice {
 public:
  /// `hysteresis`: share of the score by which another plan than the nearest must be better.
  PlanChoice(const guidance::GuidanceOptions& guidance, double hysteresis,
             const diffusion::Normalizer& normalizer, const dynamics::ActionRollout& exact)
      : guidance_(guidance), hysteresis_(hysteresis), normalizer_(normalizer), exact_(exact) {}

  /// Of the samples from `first` on, one per objective of the situation. Not finite where none of
  /// them is.
  ChosenPlan among(const std::vector<diffusion::SampledTrajectory>& samples, std::size_t first,
                   const DiffusionSituation& situation) const;
  /// These samples as candidates.
  PlanCandidates candidatesOf(const std::vector<diffusion::SampledTrajectory>& samples,
                              std::size_t first, const DiffusionSituation& situation) const;
  /// What the vehicle does with a plan from `speed` [m/s].
  traffic::Rollout drivenBy(const traffic::Rollout& plan, double speed) const;

 private:
  const guidance::GuidanceOptions& guidance_;
  double hysteresis_;
  const diffusion::Normalizer& normalizer_;
  const dynamics::ActionRollout& exact_;
};

}  // namespace cdiff::planners
