// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// J_total = sum_i w_i J_i of one vehicle at one diffusion step, with the bookkeeping of
/// GuidanceReport. Not finite -> the objective is left out of that step and counted.
#pragma once

#include "e2e_cdiff/guidance/guidance_options.h"
#include "e2e_cdiff/guidance/guidance_report.h"

namespace cdiff::guidance {

/// One per vehicle and decision. References must outlive it.
class TotalObjective {
 public:
  TotalObjective(const GuidanceOptions& options, const GuidanceScene& scene);

  /// Whether any objective acts at this diffusion step.
  bool actsAt(int diffusion_step) const;
  /// J_total of a metric rollout; `gradient` (resized to its shape) becomes dJ_total/d(rollout).
  /// `scale` [T, 7] is the size of a normalised unit in each cell: caps and reported norms are
  /// those of gradient x scale.
  double evaluate(int diffusion_step, const traffic::Rollout& rollout,
                  const traffic::Rollout& scale, traffic::Rollout& gradient);
  /// Weighted sum for ranking candidates: every objective with a weight, whatever its window. The
  /// largest double when it is not finite, so that such a candidate ranks last.
  double score(const traffic::Rollout& rollout) const;
  /// What happened so far, with the values at `chosen`.
  GuidanceReport report(const traffic::Rollout& chosen) const;

 private:
  struct Tally {
    double norm_sum = 0.0;
    std::int64_t steps = 0;
    std::int64_t capped = 0;
    std::int64_t dropped = 0;
  };
  double addObjective(std::size_t index, const traffic::Rollout& rollout,
                      const traffic::Rollout& scale, traffic::Rollout& gradient);
  const GuidanceOptions& options_;
  const GuidanceScene& scene_;
  std::vector<Tally> tallies_;  ///< by objective
  traffic::Rollout part_;       ///< gradient of one objective
};

}  // namespace cdiff::guidance
