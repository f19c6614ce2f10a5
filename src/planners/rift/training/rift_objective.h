// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <vector>

namespace cdiff::planners {

/// The group-relative objective of a batch of states, whose candidates are its groups.
struct RiftObjective {
  double clip = 0.2;        ///< of the ratio, to either side of 1
  double dual_clip = 3.0;   ///< c; 0: none
  double divergence = 0.0;  ///< weight of KL(reference || policy); 0: none
};

/// Advantages of a group: A_i = (R_i - mean R) / (std R + 1e-5), std over the group (Chen et al.
/// 2025).
std::vector<double> groupAdvantages(const std::vector<double>& returns);

/// Tensors [S, G] of S states with up to G candidates.
struct RiftRows {
  at::Tensor logits;        ///< of the policy, with gradients
  at::Tensor old_logits;    ///< when the states were gathered
  at::Tensor first_logits;  ///< of the reference: before any fine-tuning
  at::Tensor advantages;
  at::Tensor mask;  ///< 0, or -1e9 where no candidate is
};

/// - mean over states and candidates of min(rho A, clip(rho, 1 - clip, 1 + clip) A), not below
/// dual_clip A where A < 0, with rho = pi / pi_old of softmaxes over the group; plus divergence x
/// mean over them of p_ref (log p_ref - log pi).
at::Tensor riftLoss(const RiftObjective& objective, const RiftRows& rows);

}  // namespace cdiff::planners
