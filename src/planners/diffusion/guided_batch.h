// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "diffusion/sampler.h"
#include "e2e_cdiff/traffic/vehicle.h"
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

// Which of several sampled plans (rollouts [T, 7], body frame, SI units) is driven: the one of the
// lowest score; or, so that a vehicle does not waver between equal routes, the one nearest to the
// last plan while it is no worse by more than a share.

/// Index into `plans`. `previous` is the last plan as seen from here. Plans that are not finite are
/// not chosen unless none is.
std::size_t choosePlan(const std::vector<traffic::Rollout>& plans,
                       const std::vector<guidance::Score>& scores,
                       const std::optional<traffic::Rollout>& previous, double hysteresis);

}  // namespace cdiff::planners
