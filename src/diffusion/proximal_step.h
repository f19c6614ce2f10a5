// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The proximal step of guided few-step sampling: actions x of each sample go from the prediction
/// x_hat towards argmin J(x) + |x - x_hat|^2 / (2 r_k^2), at most c r_k away per element.
#pragma once

#include <vector>

#include "diffusion/sampling_batch.h"

namespace cdiff::diffusion {

struct ProximalOptions {
  int iterations = 4;
  double trust_region = 2.0;  ///< c
};

/// Gradient descent in u = (x - x_hat) / r with Barzilai-Borwein step lengths; a step that does not
/// lower the sum is halved. Changes the batch's actions and states; answers whether the trust
/// region acted, by sample. `radius` [T, 3] is r_k.
std::vector<bool> proximalStep(const ProximalOptions& options, const std::vector<float>& radius,
                               int k, StateBranch& branch, CleanObjective& objective,
                               SamplingBatch& batch);

}  // namespace cdiff::diffusion
