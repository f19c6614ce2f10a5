// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "diffusion/network/architecture.h"
#include "learning/parameters.h"

namespace cdiff::planners {

// The networks of docs/neural_network.md with gradients: image encoder, denoiser, and the
// regression head that trains the encoder. Float32; B is the batch.

/// The image encoder with gradients: images [B, 3, H, W] to features.
class ImageEncoderNet {
 public:
  ImageEncoderNet(const diffusion::Architecture& architecture, std::uint64_t seed);

  /// Images [B, 3, H, W] scaled as in the document -> features [B, image_features]. Smaller images
  /// give a smaller map before `squeeze`, which is stretched to the map of the full size.
  at::Tensor forward(const at::Tensor& images) const;
  /// Whether the convolutions multiply in bfloat16 (sums, norms and weights stay float32).
  void setHalfPrecision(bool half_precision) { half_precision_ = half_precision; }

  learning::ParameterSet& parameters() { return parameters_; }
  const learning::ParameterSet& parameters() const { return parameters_; }

 private:
  void declareBlock(const std::string& name, std::int64_t inputs, std::int64_t outputs);
  at::Tensor block(const std::string& name, const at::Tensor& x, std::int64_t stride) const;
  at::Tensor norm(const std::string& name, const at::Tensor& x) const;
  at::Tensor convolve(const std::string& name, const at::Tensor& x, std::int64_t stride,
                      std::int64_t padding) const;

  bool half_precision_ = false;
  diffusion::Architecture architecture_;
  learning::ParameterSet parameters_;
};

/// What a batch of trajectories is conditioned on.
struct ContextBatch {
  at::Tensor features;   ///< [B, image_features]
  at::Tensor route;      ///< [B, 2 route_points]
  at::Tensor has_route;  ///< [B, 1], 0 or 1
  at::Tensor speed;      ///< [B, 1], v / 10
  // Where the architecture takes them:
  at::Tensor previous;      ///< [B, image_features] of the image before
  at::Tensor has_previous;  ///< [B, 1], 0 or 1
  at::Tensor target;        ///< [B, 1], v* / 10
  at::Tensor has_target;    ///< [B, 1], 0 or 1
};

/// The denoiser with gradients: action head, and state head on actions; everything normalized.
class DenoiserNet {
 public:
  DenoiserNet(const diffusion::Architecture& architecture, std::uint64_t seed);

  /// actions [B, T, 3] of noisy [B, T, 7] at diffusion steps k [B] (int64).
  at::Tensor predictActions(const at::Tensor& noisy, const at::Tensor& k,
                            const ContextBatch& context) const;
  /// states [B, T, 4] of actions [B, T, 3]; no gradient flows into the actions if `detach`.
  at::Tensor predictStates(const at::Tensor& actions, const at::Tensor& k,
                           const ContextBatch& context, bool detach) const;
  /// The transposed convolution of 4 taps and stride 2 as a convolution: y[2j] = w1 x[j] + w3
  /// x[j-1], y[2j+1] = w2 x[j] + w0 x[j+1]. Libtorch's own is slow.
  at::Tensor doubled(const std::string& name, const at::Tensor& x) const;
  void moveTo(const at::Device& device);

  learning::ParameterSet& parameters() { return parameters_; }
  const learning::ParameterSet& parameters() const { return parameters_; }

 private:
  void declareContext();
  void declareBlock(const std::string& name, std::int64_t inputs, std::int64_t outputs);
  void declareLevels();
  at::Tensor contextOf(const ContextBatch& context) const;
  /// [B, current_state_rows + T, 7]: noisy [B, T, 7] behind the current state.
  at::Tensor behindCurrentState(const at::Tensor& noisy, const ContextBatch& context) const;
  at::Tensor timeEmbedding(const at::Tensor& k) const;
  at::Tensor convolve(const std::string& name, const at::Tensor& x, std::int64_t stride = 1) const;
  at::Tensor smooth(const std::string& name, const at::Tensor& x) const;
  at::Tensor block(const std::string& name, const at::Tensor& x, const at::Tensor& z) const;

  diffusion::Architecture architecture_;
  learning::ParameterSet parameters_;
  at::Tensor sinusoids_;  ///< [K + 1, time_width]
};

/// Normalized rollout and auxiliary targets from [features; speed; route or 0; whether there is
/// one].
class RegressionHead {
 public:
  RegressionHead(const diffusion::Architecture& architecture, std::int64_t auxiliary,
                 std::uint64_t seed);
  /// [B, 7 T + auxiliary].
  at::Tensor forward(const ContextBatch& context) const;

  learning::ParameterSet& parameters() { return parameters_; }
  const learning::ParameterSet& parameters() const { return parameters_; }

 private:
  learning::ParameterSet parameters_;
};

}  // namespace cdiff::planners
