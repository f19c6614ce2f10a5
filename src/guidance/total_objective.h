// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "e2e_cdiff/guidance/guidance_options.h"

namespace cdiff::guidance {

// The weighted sum of the objectives, which guidance minimizes, and the score that ranks plans.

/// For ranking samples: fewer undefined objectives first, then fewer rows off the road, then the
/// lower value.
struct Score {
  std::size_t undefined = 0;  ///< objectives that are not finite
  double value = 0.0;         ///< weighted sum of the others
  std::size_t off_road = 0;   ///< rows that were looked at and leave the road

  bool operator<(const Score& other) const {
    return std::tie(undefined, off_road, value) <
           std::tie(other.undefined, other.off_road, other.value);
  }
};

/// Number of the first `rows` rows of a rollout (body frame of `scene`) at which a corner of the
/// vehicle's box is off the drivable area.
std::size_t rowsOffRoad(const GuidanceScene& scene, const traffic::Rollout& rollout,
                        Eigen::Index rows);

/// J_total = sum_i c_i w_i J_i of one sample at one diffusion step, with the bookkeeping of
/// GuidanceReport. c_i = min(1, gradient_cap / |w_i dJ_i/d tau|) where the step starts: value and
/// gradient stay those of one function within a step. Not finite there -> the objective is left out
/// of that step and counted.
/// One per sample and decision; a copy made before it acts is that of another sample, prepared for
/// the same scene. References must outlive it.
class TotalObjective {
 public:
  /// Prepares the objectives for the scene.
  TotalObjective(const GuidanceOptions& options, const GuidanceScene& scene);

  /// Whether any objective acts at this diffusion step.
  bool actsAt(int diffusion_step) const;
  /// J_total of a metric rollout; `gradient` (resized to its shape) becomes dJ_total/d(rollout).
  /// `scale` [T, 7] is the size of a normalized unit in each cell: caps and reported norms are
  /// those of gradient x scale. The first call of a diffusion step starts it; a later one is
  /// infinite where an objective is not finite that was so at first.
  double evaluate(int diffusion_step, const traffic::Rollout& rollout,
                  const traffic::Rollout& scale, traffic::Rollout& gradient);
  /// Every objective with a weight, whatever its window.
  Score score(const traffic::Rollout& rollout) const;
  /// What happened so far, with the values at `chosen`.
  GuidanceReport report(const traffic::Rollout& chosen) const;

 private:
  struct Tally {
    double norm_sum = 0.0;
    std::int64_t steps = 0;
    std::int64_t capped = 0;
    std::int64_t dropped = 0;
  };
  /// Weighted value and gradient of one objective, into part_.
  double weighted(std::size_t index, const traffic::Rollout& rollout);
  /// c_i of a step that starts; 0 to leave the objective out.
  double shareOf(std::size_t index, double value, double norm);
  GuidanceOptions options_;
  const GuidanceScene& scene_;
  std::vector<Tally> tallies_;  ///< by objective
  int step_ = 0;                ///< the diffusion step that shares_ are of
  std::vector<double> shares_;  ///< c_i; 0 for an objective that is left out
  traffic::Rollout part_;       ///< gradient of one objective
};

}  // namespace cdiff::guidance
