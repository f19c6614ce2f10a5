// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/guided_batch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cdiff::planners {

GuidedBatch::GuidedBatch(const diffusion::Normalizer& normalizer,
                         std::vector<guidance::TotalObjective*> objectives)
    : normalizer_(normalizer), objectives_(std::move(objectives)) {}

bool GuidedBatch::actsAt(std::size_t sample, int k) const { return objectives_[sample]->actsAt(k); }

double GuidedBatch::evaluate(std::size_t sample, int k, const diffusion::Trajectory& clean,
                             diffusion::Trajectory& gradient) {
  const double value = objectives_[sample]->evaluate(k, normalizer_.denormalize(clean),
                                                     normalizer_.scale, metric_gradient_);
  gradient = normalizer_.toNormalizedGradient(metric_gradient_);
  return value;
}

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
  if (scores[nearest].undefined != scores[best].undefined) return best;
  const double margin = hysteresis * std::abs(scores[nearest].value);
  return scores[nearest].value - scores[best].value <= margin ? nearest : best;
}

}  // namespace cdiff::planners
