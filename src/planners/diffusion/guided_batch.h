// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <vector>

#include "diffusion/normalizer.h"
#include "diffusion/sampler.h"
#include "guidance/total_objective.h"

namespace cdiff::planners {

/// Guidance on a batch of samples: joins the metric objectives of each vehicle to the normalized
/// trajectories that the sampler works on.
/// References must outlive it.
class GuidedBatch : public diffusion::CleanObjective {
 public:
  /// `objectives[i]` is that of sample i.
  GuidedBatch(const diffusion::Normalizer& normalizer,
              std::vector<guidance::TotalObjective*> objectives);

  bool actsAt(std::size_t sample, int k) const override;
  double evaluate(std::size_t sample, int k, const diffusion::Trajectory& clean,
                  diffusion::Trajectory& gradient) override;

 private:
  const diffusion::Normalizer& normalizer_;
  std::vector<guidance::TotalObjective*> objectives_;
  traffic::Rollout metric_gradient_;
};

}  // namespace cdiff::planners
