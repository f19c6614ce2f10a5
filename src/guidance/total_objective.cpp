// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/total_objective.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cdiff::guidance {
namespace {

using traffic::Rollout;

double normOf(const Rollout& gradient, const Rollout& scale) {
  return (gradient.array() * scale.array()).matrix().norm();
}

}  // namespace

std::size_t rowsOffRoad(const GuidanceScene& scene, const Rollout& rollout, Eigen::Index rows) {
  std::size_t off = 0;
  for (Eigen::Index row = 0; row < std::min(rows, rollout.rows()); ++row) {
    const geometry::OrientedBox box{positionOnMap(scene, rollout, row),
                                    scene.state.heading + rollout(row, traffic::kRolloutHeading),
                                    scene.dimensions.length, scene.dimensions.width};
    const auto corners = box.corners();
    off += std::any_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
      return !scene.drivable_area->contains(corner, scene.state.elevation);
    });
  }
  return off;
}

TotalObjective::TotalObjective(const GuidanceOptions& options, const GuidanceScene& scene)
    : options_(options),
      scene_(scene),
      tallies_(options.objectives.size()),
      shares_(options.objectives.size(), 0.0) {
  for (WeightedObjective& entry : options_.objectives) {
    if (entry.weight > 0.0) entry.objective->prepare(scene_);
  }
}

bool TotalObjective::actsAt(int diffusion_step) const {
  for (const WeightedObjective& entry : options_.objectives) {
    if (options_.acts(entry, diffusion_step)) return true;
  }
  return false;
}

double TotalObjective::evaluate(int diffusion_step, const Rollout& rollout, const Rollout& scale,
                                Rollout& gradient) {
  gradient.setZero(rollout.rows(), traffic::kRolloutColumns);
  const bool first_call = diffusion_step != step_;
  step_ = diffusion_step;
  double total = 0.0;
  for (std::size_t i = 0; i < options_.objectives.size(); ++i) {
    if (!options_.acts(options_.objectives[i], diffusion_step)) continue;
    if (!first_call && shares_[i] == 0.0) continue;
    const double value = weighted(i, rollout);
    const double norm = normOf(part_, scale);
    if (first_call) shares_[i] = shareOf(i, value, norm);
    if (shares_[i] == 0.0) continue;
    if (!std::isfinite(value) || !std::isfinite(norm))
      return std::numeric_limits<double>::infinity();
    gradient += shares_[i] * part_;
    total += shares_[i] * value;
  }
  return total;
}

double TotalObjective::weighted(std::size_t index, const Rollout& rollout) {
  const WeightedObjective& entry = options_.objectives[index];
  part_.setZero(rollout.rows(), traffic::kRolloutColumns);
  const double value = entry.weight * entry.objective->evaluate(scene_, rollout, part_);
  part_ *= entry.weight;
  return value;
}

double TotalObjective::shareOf(std::size_t index, double value, double norm) {
  Tally& tally = tallies_[index];
  if (!std::isfinite(value) || !std::isfinite(norm)) {
    ++tally.dropped;
    return 0.0;
  }
  ++tally.steps;
  tally.norm_sum += norm;
  const double cap = options_.objectives[index].gradient_cap;
  if (cap <= 0.0 || norm <= cap) return 1.0;
  ++tally.capped;
  return cap / norm;
}

Score TotalObjective::score(const Rollout& rollout) const {
  Rollout unused = Rollout::Zero(rollout.rows(), traffic::kRolloutColumns);
  Score score;
  for (const WeightedObjective& entry : options_.objectives) {
    if (!(entry.weight > 0.0)) continue;
    const double value = entry.weight * entry.objective->evaluate(scene_, rollout, unused);
    if (std::isfinite(value)) {
      score.value += value;
    } else {
      ++score.undefined;
    }
  }
  return score;
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
