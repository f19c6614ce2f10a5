// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <vector>

#include "planners/uniad_mini/neighbor_cells.h"
#include "planners/uniad_mini/uniad_mini_motion.h"

namespace cdiff::planners {

/// Occupancy of the BEV's cells now and at the waypoints to come: logits [agents, cells] by step,
/// row-major.
struct PredictedOccupancy {
  std::array<std::vector<float>, kOccupancySteps> logits;
  std::vector<bool> sure;  ///< by slot: agents that are there
  std::int64_t cells = 0;

  /// Of a step: the largest probability over agents that are there, by cell.
  std::vector<float> probability(std::size_t step) const;
  bool finite() const;
};

/// Occupancy (Hu et al. 2023, OccFormer): from the BEV, halved, a state for each step follows from
/// the one before by a convolution, by attention to the agents that are probably at the cell, and
/// by a feed-forward network; an agent's mask is the product of its embedding and the state on the
/// BEV's own cells.
class OccupancyDecoder {
 public:
  OccupancyDecoder(const UniadMiniArchitecture& architecture, const WeightTensors& tensors,
                   inference::InstructionSet set);
  void see(const inference::Rows& bev, const DetectedTracks& tracks, const PredictedMotion& motion,
           UniadMemory& memory, PredictedOccupancy& occupancy);

 private:
  struct Step {
    inference::LayerNorm conv_norm;
    inference::Linear conv;
    inference::LayerNorm norm;
    inference::Linear query, key, value, mask, output;
    inference::PreNormFeedForward mix;
  };
  void fuseAgents(const DetectedTracks& tracks, const PredictedMotion& motion, UniadMemory& memory);
  void placeAgents(const DetectedTracks& tracks, std::size_t step, UniadMemory& memory);
  void run(const Step& step, UniadMemory& memory, const std::vector<bool>& sure);
  void attend(const std::vector<bool>& sure);
  void answer(std::vector<float>& logits);

  UniadMiniArchitecture architecture_;
  inference::Linear bev_, fine_;
  inference::LayerNorm fine_norm_;
  inference::Mlp agent_;
  PlaceEmbedding place_;
  std::vector<Step> steps_;
  std::vector<std::int64_t> neighbors_;  ///< of the halved map
  inference::Rows agents_;               ///< fused features, by slot
  inference::Rows placed_;               ///< with their places at a step
  inference::Rows state_, normed_, gathered_, change_;
  inference::Rows queries_, keys_, values_, masks_, mixed_;
  inference::Rows base_;   ///< of the BEV, on its own cells
  inference::Rows cells_;  ///< states on the BEV's own cells, normalized
  inference::Rows joined_;
  inference::Rows places_;
};

}  // namespace cdiff::planners
