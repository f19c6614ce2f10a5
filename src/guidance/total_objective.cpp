// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/guidance/total_objective.h"

#include <cmath>
#include <limits>

namespace cdiff::guidance {
namespace {

using traffic::Rollout;

double normOf(const Rollout& gradient, const Rollout& scale) {
  return (gradient.array() * scale.array()).matrix().norm();
}

}  // namespace

TotalObjective::TotalObjective(const GuidanceOptions& options, const GuidanceScene& scene)
    : options_(options), scene_(scene), tallies_(options.objectives.size()) {}

bool TotalObjective::actsAt(int diffusion_step) const {
  for (const WeightedObjective& entry : options_.objectives) {
    if (entry.actsAt(diffusion_step)) return true;
  }
  return false;
}

double TotalObjective::evaluate(int diffusion_step, const Rollout& rollout, const Rollout& scale,
                                Rollout& gradient) {
  gradient.setZero(rollout.rows(), traffic::kRolloutColumns);
  double total = 0.0;
  for (std::size_t i = 0; i < options_.objectives.size(); ++i) {
    if (options_.objectives[i].actsAt(diffusion_step)) {
      total += addObjective(i, rollout, scale, gradient);
    }
  }
  return total;
}

double TotalObjective::addObjective(std::size_t index, const Rollout& rollout, const Rollout& scale,
                                    Rollout& gradient) {
  const WeightedObjective& entry = options_.objectives[index];
  Tally& tally = tallies_[index];
  part_.setZero(rollout.rows(), traffic::kRolloutColumns);
  const double value = entry.weight * entry.objective->evaluate(scene_, rollout, part_);
  part_ *= entry.weight;
  const double norm = normOf(part_, scale);
  if (!std::isfinite(value) || !std::isfinite(norm)) {
    ++tally.dropped;
    return 0.0;
  }
  ++tally.steps;
  tally.norm_sum += norm;
  if (entry.gradient_cap > 0.0 && norm > entry.gradient_cap) {
    ++tally.capped;
    part_ *= entry.gradient_cap / norm;
  }
  gradient += part_;
  return value;
}

double TotalObjective::score(const Rollout& rollout) const {
  Rollout unused = Rollout::Zero(rollout.rows(), traffic::kRolloutColumns);
  double total = 0.0;
  for (const WeightedObjective& entry : options_.objectives) {
    if (entry.weight > 0.0) {
      total += entry.weight * entry.objective->evaluate(scene_, rollout, unused);
    }
  }
  return std::isfinite(total) ? total : std::numeric_limits<double>::max();
}

GuidanceReport TotalObjective::report(const Rollout& chosen) const {
  Rollout unused = Rollout::Zero(chosen.rows(), traffic::kRolloutColumns);
  GuidanceReport report;
  for (std::size_t i = 0; i < options_.objectives.size(); ++i) {
    const WeightedObjective& entry = options_.objectives[i];
    if (!(entry.weight > 0.0)) continue;
    const Tally& tally = tallies_[i];
    const auto steps = static_cast<double>(tally.steps);
    ObjectiveReport line;
    line.name = entry.name;
    line.weight = entry.weight;
    line.value = entry.objective->evaluate(scene_, chosen, unused);
    if (tally.steps > 0) {
      line.gradient_norm = tally.norm_sum / steps;
      line.capped_share = static_cast<double>(tally.capped) / steps;
    }
    line.dropped = tally.dropped;
    report.objectives.push_back(std::move(line));
  }
  return report;
}

}  // namespace cdiff::guidance
