// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "planners/uniad_mini/motion_anchors.h"
#include "planners/uniad_mini/uniad_mini_tracks.h"

namespace cdiff::planners {

/// Features of the modes of track queries: row = query x modes + mode, the ego's last.
struct PredictedMotion {
  inference::Rows modes;   ///< normalized
  inference::Rows places;  ///< embedded places of the queries, by query
};

/// Motion of agents and ego (Hu et al. 2023, MotionFormer): a query for each track and mode starts
/// from the anchor of its group, turned into the track's heading; each layer attends to the tracks,
/// to the map and by deformable attention to the BEV around where the mode ends so far, fuses the
/// three with the track's features, and adds up offsets from waypoint to waypoint to the anchor.
class MotionDecoder {
 public:
  MotionDecoder(const UniadMiniArchitecture& architecture, const WeightTensors& tensors,
                inference::InstructionSet set);
  /// Writes ways and their scores to seen.agents. `map`: features of lines.
  PredictedMotion see(const inference::Rows& bev, const inference::Rows& map, UniadMemory& memory,
                      DetectedTracks& seen);

 private:
  struct Layer {
    inference::PreNormAttention agents;
    inference::PreNormAttention map;
    inference::LayerNorm bev_norm;
    inference::DeformableAttention bev;
    inference::Mlp fuse;
    inference::LayerNorm norm;
    inference::Mlp offset;
    inference::Mlp score;
  };
  void start(UniadMemory& memory, const DetectedTracks& seen);
  void turnAnchors(const DetectedTracks& seen);
  void run(const Layer& layer, const inference::Rows& bev, const inference::Rows& map,
           UniadMemory& memory, const DetectedTracks& seen);
  void addOffsets(const Layer& layer, UniadMemory& memory);
  void readBev(const Layer& layer, const inference::Rows& bev, UniadMemory& memory);
  void readScores(UniadMemory& memory, const inference::Rows& modes, DetectedTracks& seen) const;

  UniadMiniArchitecture architecture_;
  std::array<MotionAnchors, kMotionGroups> anchors_;
  inference::Mlp embed_;
  inference::Rows mode_;
  PlaceEmbedding place_;
  std::vector<Layer> layers_;
  std::vector<EgoWaypoints> turned_;  ///< by row: anchors in the ego's axes, at the track's place
  std::vector<EgoWaypoints> ways_;    ///< by row, as answered so far
  inference::Rows x_, of_agents_, of_map_, of_bev_, joined_, numbers_, context_;
};

}  // namespace cdiff::planners
