// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "learning/task.h"
#include "planners/pluto/training/pluto_trainer_network.h"

namespace cdiff::planners {

// Losses of Pluto (Cheng et al. 2024, III-C and III-D; docs/pluto.md), all of weight 1. Moments
// that imitate nothing (negatives) count in the contrastive loss alone.

/// How far the body lies outside the drivable area, on plans [B, 80, 6] of the examples: three
/// circles along the body, of radius sqrt(width^2 + (length / 3)^2) / 2 - 0.2 m, its excess over
/// the signed distance to the border on the level where the vehicle then was, mean over circles and
/// `weights` [B, 80, 1]. Its gradient follows that of the signed distance.
at::Tensor areaLoss(const at::Tensor& plans, const at::Tensor& weights,
                    const std::vector<const PlutoExample*>& examples);

/// Cross entropy of the positive against the negative of each triplet: with directions a, p and n,
/// softmax(a p / 0.1, a n / 0.1). [T, width] each; 0 without triplets.
at::Tensor contrastLoss(const at::Tensor& anchors, const at::Tensor& positives,
                        const at::Tensor& negatives);

/// Rows of the batch that make triplets.
struct Triplet {
  std::int64_t anchor = 0;
  std::int64_t positive = 0;
  std::int64_t negative = 0;
};

/// Sum of: smooth L1 of the chosen candidate (sum over its six channels), cross entropy of lines x
/// modes, smooth L1 of agents' futures and of the free plan, areaLoss, and contrastLoss where there
/// are triplets.
learning::Loss plutoLoss(const PlutoNet& net, const PlutoBatch& batch,
                         const std::vector<const PlutoExample*>& examples,
                         const LayerFactors& factors, const std::vector<Triplet>& triplets);

}  // namespace cdiff::planners
