// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "inference/transformer_layers.h"
#include "planners/pluto/pluto_scene.h"

namespace cdiff::planners {

// Encoders of the elements of one scene (poses, polylines, agents, the controlled vehicle itself):
// each element becomes a row of `width` features. Inputs are scaled and in the frames of
// pluto_scene.h. Used by PlutoNetwork.

/// Fourier features of poses: each number x becomes cos(2 pi f x) and sin(2 pi f x) for its 16
/// learned frequencies f, and x itself; an Mlp maps them to `width`. Tensors
/// table.position.frequency and position.*.
class PositionEmbedding {
 public:
  explicit PositionEmbedding(const inference::LayerWeights& weights);
  void apply(const std::vector<PlutoPose>& poses, inference::Rows& output);

 private:
  std::vector<float> frequencies_;  ///< [kPoseNumbers, kPlutoFrequencies]
  inference::Mlp mlp_;
  inference::Rows features_;
  inference::Rows hidden_;
};

/// PointNet (Qi et al. 2017) of a set of points: h = Mlp(p), g = max over points of h, output = max
/// over points of Mlp(h, g). Tensors NAME.first.* and NAME.second.*.
class PointNet {
 public:
  PointNet(const inference::LayerWeights& weights, const std::string& name);
  /// `points`: [count, channels]; writes one row of features to `output`.
  void apply(const float* points, std::int64_t count, std::int64_t channels, float* output);

 private:
  inference::Mlp first_;
  inference::Mlp second_;
  inference::Rows points_;
  inference::Rows middle_;  ///< [count, 2 x width]
  inference::Rows last_;
  inference::Rows hidden_;
};

/// Three convolutions over the time of an agent's history (strides 1, 2, 2; kernel 3; each followed
/// by max(0, x)), then a linear layer over the flattened result. Tensors agent.*.
class HistoryNet {
 public:
  explicit HistoryNet(const inference::LayerWeights& weights);
  /// One row for each agent.
  void apply(const std::vector<PlutoAgent>& agents, inference::Rows& output);

 private:
  inference::Convolution first_;
  inference::Convolution second_;
  inference::Convolution third_;
  inference::Linear join_;
  inference::Activation history_;
  inference::Activation middle1_;
  inference::Activation middle2_;
  inference::Activation middle3_;
  inference::Rows joined_;
};

/// Encodes the motion of the controlled vehicle: a learned query attends to a learned token and to
/// one token each for speed, acceleration and steer, namely learned embedding + value x learned
/// gain. Tensors own.*.
class OwnStateEncoder {
 public:
  OwnStateEncoder(const inference::LayerWeights& weights, const inference::TransformerSizes& sizes);
  void apply(const std::array<float, kMotionNumbers>& motion, const inference::View& output,
             inference::TransformerMemory& memory);

 private:
  const inference::TransformerKernels* kernels_;
  inference::TransformerSizes sizes_;
  inference::Rows query_;
  std::vector<float> place_;  ///< embeddings [1 + kMotionNumbers, width]
  std::vector<float> gain_;   ///< [kMotionNumbers, width]
  inference::Linear key_value_;
  inference::Linear output_;
  inference::Rows tokens_;
};

/// The tensor `name` [rows, channels], a learned table, as rows.
inference::Rows tableRows(const inference::LayerWeights& weights, const std::string& name);

}  // namespace cdiff::planners
