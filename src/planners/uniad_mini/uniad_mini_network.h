// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "planners/uniad_mini/uniad_mini_occupancy.h"

namespace cdiff::planners {

/// What is asked of the network.
struct UniadMiniInput {
  std::vector<const std::uint8_t*> images;  ///< rgb8, in the rig's order
  EgoMotion motion{};
  EgoPoses poses;
  const inference::Rows* past = nullptr;  ///< BEV of poses.past
  const TrackSet* past_tracks = nullptr;  ///< likewise
  RoadCommand command = RoadCommand::kFollow;
};

/// What the network answers (body frame, SI units).
struct UniadMiniOutput {
  std::vector<DetectedAgent> agents;  ///< by slot
  std::vector<DetectedLine> lines;    ///< by query
  PredictedOccupancy occupancy;
  EgoWaypoints plan{};  ///< for the command that was asked [m]
  TrackSet tracks;      ///< for the decision half a second later

  bool finite() const;
};

/// The planner's query (Hu et al. 2023): the ego's motion modes, its track and the command, the
/// largest over modes; layers of attention to the BEV behind a convolutional adapter; offsets from
/// waypoint to waypoint.
class PlanDecoder {
 public:
  PlanDecoder(const UniadMiniArchitecture& architecture, const WeightTensors& tensors,
              inference::InstructionSet set);
  EgoWaypoints plan(const inference::Rows& bev, const DetectedTracks& tracks,
                    const PredictedMotion& motion, RoadCommand command, UniadMemory& memory);

 private:
  struct Layer {
    inference::PreNormAttention attention;
    inference::PreNormFeedForward mix;
  };
  void adapt(const inference::Rows& bev);
  void ask(const DetectedTracks& tracks, const PredictedMotion& motion, RoadCommand command,
           UniadMemory& memory);

  UniadMiniArchitecture architecture_;
  inference::Rows command_, positions_;
  inference::Mlp query_;
  inference::Linear narrow_, widen_;
  inference::LayerNorm bev_norm_;
  std::vector<Layer> layers_;
  inference::LayerNorm norm_;
  inference::Mlp way_;
  std::vector<std::int64_t> neighbors_;
  inference::Rows gathered_, narrowed_, tokens_, joined_, asked_, x_;
};

/// The network of `uniad_mini` at run time (docs/uniad_mini.md): BEV encoder, tracks, map, motion,
/// occupancy, plan. Float32, deterministic, without libtorch; one object per thread.
class UniadMiniNetwork {
 public:
  explicit UniadMiniNetwork(const UniadMiniModel& model,
                            inference::InstructionSet set = inference::bestInstructionSet());
  UniadMiniOutput forward(const UniadMiniInput& input);
  /// The BEV of the last forward.
  const inference::Rows& bev() const { return *bev_; }
  /// The BEV of the last forward's images without a past one (BevEncoder::encodeAlone), in its
  /// place.
  const inference::Rows& bevAlone(const EgoMotion& motion) { return encoder_.encodeAlone(motion); }

 private:
  BevEncoder encoder_;
  TrackDecoder tracks_;
  MapDecoder map_;
  MotionDecoder motion_;
  OccupancyDecoder occupancy_;
  PlanDecoder plan_;
  const inference::Rows* bev_ = nullptr;
  inference::Rows map_tokens_;
  UniadMemory memory_;
};

}  // namespace cdiff::planners
