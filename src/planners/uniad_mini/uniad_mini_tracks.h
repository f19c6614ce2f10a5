// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "planners/uniad_mini/track_set.h"
#include "planners/uniad_mini/uniad_mini_weights.h"
#include "planners/vad_mini/vad_mini_network.h"

namespace cdiff::planners {

/// Buffers that the decoders of a network share.
struct UniadMemory {
  inference::TransformerMemory transformer;
  inference::DeformableMemory deformable;
  inference::Rows head;
  inference::Rows shares;  ///< places as shares of the BEV in [-1, 1]
};

/// Places (body frame [m]) as rows of features, by the learned layers "place".
class PlaceEmbedding {
 public:
  PlaceEmbedding(const inference::LayerWeights& weights, const CameraEgoSizes& sizes)
      : bev_(sizes.bev), width_(sizes.width), place_(weights, "place") {}
  void apply(const std::vector<Eigen::Vector2d>& places, UniadMemory& memory,
             inference::Rows& rows) const;

 private:
  BevGrid bev_;
  std::int64_t width_;
  inference::Mlp place_;
};

/// Track queries of a decision, those of the slots and then the ego's (body frame, SI units).
struct DetectedTracks {
  std::vector<DetectedAgent> agents;     ///< by slot
  std::vector<Eigen::Vector2d> centers;  ///< by row: of the slots, and the ego's own place
  inference::Rows features;              ///< by row, normalized
  TrackSet kept;                         ///< for the decision half a second later
};

/// Track queries (Hu et al. 2023, UniAD; Zeng et al. 2022, MOTR): decoder layers on learned queries
/// and on the tracks of half a second ago, which were moved by their velocity, and the update of
/// their contents by attention among all.
class TrackDecoder {
 public:
  TrackDecoder(const UniadMiniArchitecture& architecture, const WeightTensors& tensors,
               inference::InstructionSet set);
  /// `past`: of poses.past, or nullptr.
  void see(const inference::Rows& bev, const EgoPoses& poses, const TrackSet* past,
           UniadMemory& memory, DetectedTracks& seen);

 private:
  struct Layer {
    QueryLayer layer;
    inference::LayerNorm norm;
    inference::Linear score;
    inference::Mlp box;
  };
  void start(const EgoPoses& poses, const TrackSet* past, UniadMemory& memory);
  void decode(const inference::Rows& bev, UniadMemory& memory, DetectedTracks& seen);
  void answer(UniadMemory& memory, DetectedTracks& seen) const;
  void keep(UniadMemory& memory, DetectedTracks& seen) const;

  UniadMiniArchitecture architecture_;
  std::vector<Layer> layers_;
  inference::Rows content_, reference_, ego_;
  PlaceEmbedding place_;
  inference::PreNormAttention update_;
  inference::PreNormFeedForward update_mix_;
  std::vector<bool> held_;     ///< by slot, whether it started as a track
  inference::Rows x_, start_;  ///< queries; their references
  inference::Rows position_;
};

/// Map queries: a class and ten points each.
class MapDecoder {
 public:
  MapDecoder(const UniadMiniArchitecture& architecture, const WeightTensors& tensors,
             inference::InstructionSet set);
  /// Lines, and their normalized features to `tokens`.
  std::vector<DetectedLine> see(const inference::Rows& bev, UniadMemory& memory,
                                inference::Rows& tokens);

 private:
  struct Layer {
    QueryLayer layer;
    inference::LayerNorm norm;
    inference::Linear kinds;
    inference::Mlp points;
  };
  std::array<Eigen::Vector2d, kMapPoints> pointsOf(std::int64_t line) const;
  void decode(const inference::Rows& bev, UniadMemory& memory, const inference::Rows& tokens);

  UniadMiniArchitecture architecture_;
  std::vector<Layer> layers_;
  inference::Rows content_, position_, reference_;
  inference::Rows x_, points_;
};

}  // namespace cdiff::planners
