// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/training/rift_objective.h"

#include <cmath>

namespace cdiff::planners {

std::vector<double> groupAdvantages(const std::vector<double>& returns) {
  constexpr double kLeast = 1e-5;
  const auto count = static_cast<double>(returns.size());
  double mean = 0.0;
  for (const double value : returns) mean += value / count;
  double variance = 0.0;
  for (const double value : returns) variance += (value - mean) * (value - mean) / count;
  std::vector<double> advantages;
  for (const double value : returns)
    advantages.push_back((value - mean) / (std::sqrt(variance) + kLeast));
  return advantages;
}

at::Tensor riftLoss(const RiftObjective& objective, const RiftRows& rows) {
  const at::Tensor valid = (rows.mask == 0.0).to(rows.logits.scalar_type());
  const at::Tensor log_policy = at::log_softmax(rows.logits + rows.mask, 1);
  const at::Tensor log_old = at::log_softmax(rows.old_logits + rows.mask, 1);
  const at::Tensor ratio = at::exp((log_policy - log_old) * valid);
  const at::Tensor clipped = ratio.clamp(1.0 - objective.clip, 1.0 + objective.clip);
  at::Tensor surrogate = at::minimum(ratio * rows.advantages, clipped * rows.advantages);
  if (objective.dual_clip > 0.0) {
    const at::Tensor floor = at::maximum(surrogate, objective.dual_clip * rows.advantages);
    surrogate = at::where(rows.advantages < 0.0, floor, surrogate);
  }
  at::Tensor loss = -(surrogate * valid).sum() / valid.sum();
  if (objective.divergence > 0.0) {
    const at::Tensor log_reference = at::log_softmax(rows.first_logits + rows.mask, 1);
    const at::Tensor divergence = at::exp(log_reference) * (log_reference - log_policy);
    loss = loss + objective.divergence * (divergence * valid).sum() / valid.sum();
  }
  return loss;
}

}  // namespace cdiff::planners
