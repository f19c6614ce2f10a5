// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/plan_choice.h"

#include <algorithm>
#include <cmath>

namespace cdiff::planners {
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

Rollout PlanChoice::drivenBy(const Rollout& plan, double speed) const {
  Rollout driven = plan;
  dynamics::makeExecutable(driven);
  exact_.rollOut(speed, driven);
  return driven;
}

PlanCandidates PlanChoice::candidatesOf(const std::vector<diffusion::SampledTrajectory>& samples,
                                        std::size_t first,
                                        const DiffusionSituation& situation) const {
  PlanCandidates candidates;
  auto& [plans, driven, scores, shares] = candidates;
  const Eigen::Index rows = std::lround(guidance_.road_horizon / traffic::kRolloutStep);
  for (std::size_t i = 0; i < situation.objectives.size(); ++i) {
    plans.push_back(normalizer_.denormalize(samples[first + i].clean));
    driven.push_back(drivenBy(plans.back(), situation.scene.state.speed));
    scores.push_back(situation.objectives[i]->score(plans.back()));
    const diffusion::SampledTrajectory& sample = samples[first + i];
    shares.push_back(static_cast<double>(sample.trust_region_hits) /
                     std::max(1.0, static_cast<double>(sample.guided_steps)));
    scores.back().off_road = guidance::rowsOffRoad(situation.scene, driven.back(), rows);
  }
  return candidates;
}

ChosenPlan PlanChoice::among(const std::vector<diffusion::SampledTrajectory>& samples,
                             std::size_t first, const DiffusionSituation& situation) const {
  PlanCandidates candidates = candidatesOf(samples, first, situation);
  const auto& [plans, driven, scores, shares] = candidates;
  const std::size_t best = choosePlan(plans, scores, situation.previous, hysteresis_);
  ChosenPlan chosen{plans[best], driven[best], situation.objectives[best]->report(plans[best])};
  chosen.report.candidates = guidance_.candidates;
  chosen.report.chosen = static_cast<std::int64_t>(best);
  chosen.report.trust_region_share = shares[best];
  chosen.weighed = std::move(candidates);
  return chosen;
}

}  // namespace cdiff::planners
