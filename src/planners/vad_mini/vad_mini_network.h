// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <string>
#include <vector>

#include "planners/camera_ego/bev_encoder.h"
#include "planners/vad_mini/vad_mini_weights.h"

namespace cdiff::planners {

/// An agent query's answer (body frame of the ego, SI units).
struct DetectedAgent {
  float score = 0.0F;                             ///< logit of being a vehicle
  std::array<float, kBoxNumbers> box{};           ///< center of the box, kBoxNumbers
  std::array<EgoWaypoints, kMotionModes> ways{};  ///< where it will be
  std::array<float, kMotionModes> way_scores{};   ///< logits of the ways
};

/// A map query's answer.
struct DetectedLine {
  std::array<float, kMapKinds> scores{};             ///< logits
  std::array<Eigen::Vector2d, kMapPoints> points{};  ///< body frame of the ego [m]
};

/// Probability of a logit.
double logistic(float logit);
/// A row for each pair of rows of two tables, the second counting faster: their sum.
inference::Rows rowSums(const inference::Rows& first, const inference::Rows& second,
                        std::int64_t channels);

/// What the network answers.
struct VadMiniOutput {
  std::vector<DetectedAgent> agents;                ///< by query
  std::vector<DetectedLine> lines;                  ///< by query
  std::array<EgoWaypoints, kRoadCommands> plans{};  ///< by command (body frame [m])

  bool finite() const;
};

/// What is asked of the network.
struct VadMiniInput {
  std::vector<const std::uint8_t*> images;  ///< rgb8, in the rig's order
  EgoMotion motion{};
  EgoPoses poses;
  const inference::Rows* past = nullptr;  ///< BEV of poses.past
};

/// The network of `vad_mini` at run time (docs/vad_mini.md): BEV encoder, decoders of agents and
/// map, motion modes, and an ego query that looks at agents, then at the map. Float32,
/// deterministic, without libtorch; one object per thread.
class VadMiniNetwork {
 public:
  explicit VadMiniNetwork(const VadMiniModel& model,
                          inference::InstructionSet set = inference::bestInstructionSet());
  VadMiniOutput forward(const VadMiniInput& input);
  /// The BEV of the last forward.
  const inference::Rows& bev() const { return *bev_; }
  /// The BEV of the last forward's images without a past one (BevEncoder::encodeAlone), in its
  /// place.
  const inference::Rows& bevAlone(const EgoMotion& motion) { return encoder_.encodeAlone(motion); }

 private:
  /// A layer of a decoder with its heads.
  struct Decoder {
    QueryLayer layer;
    inference::LayerNorm norm;
    inference::Linear kind;
    inference::Mlp change;  ///< of boxes or points
  };
  /// Attention of some rows to others, and a feed-forward network.
  struct Interaction {
    inference::PreNormAttention attention;
    inference::PreNormFeedForward mix;

    Interaction(const inference::LayerWeights& weights, const std::string& name,
                const CameraEgoSizes& sizes)
        : attention(weights, name, sizes.transformer()), mix(weights, name + ".mix") {}
  };
  std::vector<Decoder> decodersOf(const inference::LayerWeights& weights, const std::string& name,
                                  const char* change) const;
  void seeAgents(VadMiniOutput& output);
  void seeMap(VadMiniOutput& output);
  void scoreLines(const Decoder& decoder, VadMiniOutput& output);
  void makeMapTokens(const VadMiniOutput& output);
  void forecast(VadMiniOutput& output);
  void readForecasts(VadMiniOutput& output);
  void plan(VadMiniOutput& output);
  void startEgo();
  /// Places by their shares of the BEV as rows of features.
  void embedPlaces(const std::vector<Eigen::Vector2d>& places, inference::Rows& rows);

  VadMiniArchitecture architecture_;
  BevEncoder encoder_;
  std::vector<Decoder> agent_decoders_;
  std::vector<Decoder> map_decoders_;
  inference::Rows agent_content_, agent_position_, agent_reference_;
  inference::Rows map_content_, map_position_, map_reference_;  ///< by line and point
  inference::Mlp shape_;
  inference::Mlp place_;
  inference::Rows mode_;
  Interaction motion_agents_, motion_map_;
  inference::LayerNorm motion_norm_;
  inference::Mlp motion_offset_, motion_score_;
  inference::Mlp fuse_;
  inference::Rows ego_;
  inference::Linear ego_bev_;
  Interaction ego_agents_, ego_map_;
  inference::LayerNorm ego_norm_;
  inference::Mlp plan_;

  const inference::Rows* bev_ = nullptr;
  inference::Rows agents_;      ///< normalized features of the last layer, by query
  inference::Rows map_points_;  ///< likewise, by line and point
  inference::Rows map_tokens_;  ///< by line
  inference::Rows modes_;       ///< by agent and mode
  inference::Rows joined_;
  inference::Rows tokens_;  ///< what the ego query attends to
  inference::Rows ego_row_, ego_joined_;
  inference::Rows positions_, points_, head_, x_;
  inference::TransformerMemory memory_;
  inference::DeformableMemory deformable_;
};

}  // namespace cdiff::planners
