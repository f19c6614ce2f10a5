// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "learning/task.h"
#include "planners/vad_mini/training/plan_losses.h"
#include "planners/vad_mini/training/vad_mini_trainer_network.h"

namespace cdiff::planners {

/// Which losses count, and how much.
struct VadMiniLossOptions {
  SetLossWeights sets;
  PlanLossOptions plan;
  bool intermediate = true;  ///< detection, forecasts and map are supervised
  bool constraints = true;   ///< boundary, collision and direction count
};

/// The loss of a batch: sets at every decoder layer, forecasts of the agents that the last one
/// matched, and the commanded plan.
learning::Loss vadMiniLoss(const VadMiniAnswer& answer, const BevGrid& bev,
                           const std::vector<const EgoExample*>& examples,
                           const VadMiniLossOptions& options);

/// What the network sees around, for the constraints on its plans.
DetectedSurroundings seenAround(const VadMiniAnswer& answer, const BevGrid& bev);

}  // namespace cdiff::planners
