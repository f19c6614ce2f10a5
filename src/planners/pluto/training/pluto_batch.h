// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <vector>

#include "learning/parameters.h"
#include "planners/pluto/training/pluto_examples.h"

namespace cdiff::planners {

/// Several moments as tensors: B moments, A agents, P polygons, R lines, each padded to the most of
/// a moment; U pieces of lanes; L points of a line. Masks hold 0, or -1e9 where nothing is.
struct PlutoBatch {
  at::Tensor motion;       ///< [B, 3]
  at::Tensor motion_mask;  ///< [B, 1, 1, 4]: -1e9 on the tokens that dropout takes
  at::Tensor history;      ///< [B, A, 20, 9]
  at::Tensor kinds;        ///< int64 [B, A]
  at::Tensor pieces;       ///< [U, 20, 10]
  at::Tensor piece_of;     ///< int64 [B, P]
  at::Tensor internal;     ///< int64 [B, P]
  at::Tensor on_route;     ///< int64 [B, P]
  at::Tensor light;        ///< int64 [B, P]
  at::Tensor limit;        ///< [B, P, 1]
  at::Tensor poses;        ///< [B, 1 + A + P, 3], the vehicle's own (0) first
  at::Tensor mask;         ///< [B, 1, 1, 1 + A + P]
  at::Tensor lines;        ///< [B, R, L, 6]
  at::Tensor point_mask;   ///< [B, R, L, 1]
  at::Tensor line_poses;   ///< [B, R, 3]
  at::Tensor line_mask;    ///< [B, R]
  // What is to be answered.
  at::Tensor chosen;         ///< int64 [B]: line x 12 + mode
  at::Tensor future;         ///< [B, 80, 6]
  at::Tensor future_weight;  ///< [B, 80, 1]: 1 where it counts
  at::Tensor imitates;       ///< [B]
  at::Tensor agent_future;   ///< [B, A, 80, 6]
  at::Tensor agent_weight;   ///< [B, A, 80, 1]
};

/// Input dropout: what is hidden from the network, by moment.
struct PlutoDropout {
  std::vector<std::array<bool, kMotionNumbers>> motion;  ///< true: not shown
  std::vector<std::int64_t> history;  ///< differences that are shown, the last ones
};

/// `dropout` may be empty.
PlutoBatch plutoBatch(const std::vector<const PlutoExample*>& examples, const PlutoDropout& dropout,
                      const at::Device& device);

}  // namespace cdiff::planners
