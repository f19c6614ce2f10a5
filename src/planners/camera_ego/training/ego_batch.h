// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "planners/camera_ego/training/bev_trainer_network.h"
#include "planners/camera_ego/training/ego_examples.h"

namespace cdiff::planners {

/// The looks of B examples, `back` looks before the present one (0: the present); examples that
/// have none so far back stand with their first.
BevBatch bevBatch(const std::vector<const EgoExample*>& examples, std::size_t back,
                  const BevGrid& bev, const at::Device& device);

/// The BEV of the present [B x cells, width]: the past looks one after the other without gradients,
/// each with the BEV of the one before where there is one.
at::Tensor encodeFrames(const BevNet& net, const std::vector<const EgoExample*>& examples,
                        const CameraEgoSizes& sizes, const at::Device& device);

}  // namespace cdiff::planners
