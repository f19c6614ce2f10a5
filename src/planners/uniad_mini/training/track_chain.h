// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "learning/task.h"
#include "planners/camera_ego/training/ego_batch.h"
#include "planners/camera_ego/training/set_losses.h"
#include "planners/uniad_mini/training/uniad_mini_trainer_network.h"

namespace cdiff::planners {

/// Which slots hold tracks of which vehicles, for one sample.
struct HeldTracks {
  std::vector<bool> live;                              ///< by slot
  std::vector<std::optional<std::uint32_t>> vehicles;  ///< number in the scene; none: a false one

  explicit HeldTracks(std::size_t slots = 0) : live(slots, false), vehicles(slots) {}
};

/// The slot of each label; -1: none. A label whose vehicle a live slot holds is that slot's; the
/// others are matched to the slots that hold nothing at the lowest cost. `logits` [A, 1] and
/// `boxes` [A, 10] of one sample.
std::vector<int> matchTracks(const at::Tensor& logits, const at::Tensor& boxes,
                             const std::vector<AgentLabel>& labels, const HeldTracks& held,
                             const SetLossWeights& weights);

/// How tracks are disturbed in training (Zeng et al. 2022, MOTR; UniAD's rates).
struct TrackDropOptions {
  double dropped = 0.1;         ///< chance that a matched slot does not go on
  double false_positive = 0.3;  ///< chance that an unmatched slot that seems a track goes on
};

/// Draws of one sample at one look.
struct TrackDraws {
  const core::RandomStream& random;
  core::RandomKey key;
};

/// What slots hold after a look: those that were matched, but for dropped ones, and some that were
/// not although their score is that of a track. `logits` [A, 1] of the last layer.
HeldTracks heldAfter(const at::Tensor& logits, const std::vector<AgentLabel>& labels,
                     const std::vector<int>& matches, const TrackDropOptions& options,
                     const TrackDraws& draws);

/// What is known of a batch's present look, after the looks before it.
struct FollowedTracks {
  at::Tensor bev;      ///< of the present [B x cells, width]
  TrackAnswer answer;  ///< of the present
  QueryMatches matches;
  at::Tensor kind;  ///< loss of scores, mean over looks
  at::Tensor box;
};

/// How a batch's looks are followed.
struct FollowOptions {
  at::Device device = at::kCPU;
  TrackDropOptions drops;
  SetLossWeights weights;
};

/// Follows the tracks of a batch from look to look: BEV of the look before without gradients,
/// tracks with them. `step`: for the draws.
FollowedTracks followTracks(const UniadMiniNet& net, const std::vector<const EgoExample*>& examples,
                            const FollowOptions& options, const core::RandomStream& random,
                            std::int64_t step);

}  // namespace cdiff::planners
