// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <vector>

#include "planners/camera_ego/training/ego_examples.h"

namespace cdiff::planners {

// Losses of sets of queries against sets of labels, matched one to one at the lowest cost (Carion
// et al. 2020; Hungarian matching), with the weights that VAD and UniAD publish.

/// Weights of the terms.
struct SetLossWeights {
  double kind = 2.0;              ///< focal loss of classes, and its cost
  double box = 0.25;              ///< L1 of boxes, and its cost
  double velocity = 0.2;          ///< of vx and vy within a box, besides
  double line_kind = 2.0;         ///< focal loss of lines, and its cost
  double line_points = 1.0;       ///< L1 of their points as shares of the BEV, summed, and its cost
  double line_direction = 0.005;  ///< 1 - cos of the segments' directions, summed
};

/// Focal loss (Lin et al. 2017; alpha 0.25, gamma 2) of logits against targets in {0, 1}, summed.
at::Tensor focalLoss(const at::Tensor& logits, const at::Tensor& targets);

/// Which query answers to which label of a sample; -1: none.
using QueryMatches = std::vector<std::vector<int>>;  ///< by sample and label

/// Queries [B, A, .] against the agents of the examples.
QueryMatches matchAgents(const at::Tensor& logits, const at::Tensor& boxes,
                         const std::vector<const EgoExample*>& examples,
                         const SetLossWeights& weights);
/// The loss of classes and of boxes, divided by the number of labels (at least 1).
struct AgentLoss {
  at::Tensor kind;
  at::Tensor box;
};
AgentLoss agentLoss(const at::Tensor& logits, const at::Tensor& boxes,
                    const std::vector<const EgoExample*>& examples, const QueryMatches& matches,
                    const SetLossWeights& weights);

/// The loss of the map's lines: logits [B, L, 3], lines [B, L, 10, 2] as shares of the BEV. Lines
/// without direction are matched from the end that fits better.
struct LineLoss {
  at::Tensor kind;
  at::Tensor points;
  at::Tensor direction;
};
LineLoss lineLoss(const at::Tensor& logits, const at::Tensor& lines,
                  const std::vector<const EgoExample*>& examples, const BevGrid& bev,
                  const SetLossWeights& weights);

/// Cost of a class by the focal loss, of a probability p: loss of 1 minus loss of 0.
double focalCost(double logit);

}  // namespace cdiff::planners
