// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/guided_batch.h"

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

}  // namespace cdiff::planners
