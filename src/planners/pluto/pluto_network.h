// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <vector>

#include "inference/instruction_set.h"
#include "planners/pluto/pluto_layers.h"
#include "planners/pluto/pluto_weights.h"

namespace cdiff::planners {

inline constexpr double kPlutoPlaceUnit = 20.0;  ///< what a place of 1 at the output stands for [m]
inline constexpr double kPlutoSpeedUnit = 10.0;  ///< likewise, of a velocity [m/s]

/// A trajectory in the vehicle's frame [80, 6]: row t is 0.1 s x (t + 1) ahead; x, y [m], cos and
/// sin of the heading (of any length), vx, vy [m/s].
using PlutoTrajectory = Eigen::Matrix<float, kPlutoSteps, kPlutoChannels, Eigen::RowMajor>;
/// Likewise without velocities, of the plan that follows no reference line [80, 4].
using FreeTrajectory = Eigen::Matrix<float, kPlutoSteps, kFreeChannels, Eigen::RowMajor>;

/// What the network says about a moment. Candidates are line by line, mode by mode.
struct PlutoOutput {
  std::vector<PlutoTrajectory> candidates;  ///< lines x 12
  std::vector<float> logits;                ///< by candidate
  std::vector<float> features;  ///< [lines x 12, width]: what the score head reads of each
  FreeTrajectory free;
};

/// The network of `pluto` and `rift` (Cheng et al. 2024 at reduced width; docs/pluto.md): tokens of
/// the vehicle, its neighbors and the lanes through a transformer's encoder; a query for each
/// reference line and longitudinal mode attends to its like and to the scene; heads give trajectory
/// and score. One moment at a time, so each has the same output to the last bit, whatever the
/// others are.
class PlutoNetwork {
 public:
  /// `pieces` are encoded once.
  PlutoNetwork(const PlutoModel& model, const std::vector<LanePiece>& pieces,
               inference::InstructionSet set = inference::bestInstructionSet());

  PlutoOutput forward(const PlutoInput& input);

 private:
  /// The layers of a decoder's round.
  struct DecoderLayer {
    inference::PreNormAttention lines;
    inference::PreNormAttention modes;
    inference::PreNormAttention scene;
    inference::PreNormFeedForward mix;
  };
  /// Those of an encoder's.
  struct EncoderLayer {
    inference::PreNormAttention attention;
    inference::PreNormFeedForward mix;
  };
  void encodePieces(const std::vector<LanePiece>& pieces);
  void embedTokens(const PlutoInput& input);
  void embedPolygons(const PlutoInput& input, std::int64_t first);
  void encode();
  void makeQueries(const PlutoInput& input);
  void decode(std::int64_t lines);
  void readHeads(PlutoOutput& output);

  PlutoArchitecture architecture_;
  OwnStateEncoder own_;
  HistoryNet history_;
  PointNet polygon_net_;
  PointNet line_net_;
  PositionEmbedding position_;
  inference::Rows kind_, internal_, on_route_, light_, limit_, mode_, mode_position_;
  std::vector<EncoderLayer> encoder_;
  inference::LayerNorm encoder_norm_;
  inference::Linear query_;
  std::vector<DecoderLayer> decoder_;
  inference::LayerNorm decoder_norm_;
  inference::Linear join_;
  inference::Mlp place_, heading_, velocity_, score_, free_;
  inference::Rows piece_features_;  ///< by piece
  // Memory of a call.
  inference::Rows tokens_, agents_, positions_, lines_, joined_, queries_, head_, hidden_, none_;
  inference::TransformerMemory memory_;
};

}  // namespace cdiff::planners
