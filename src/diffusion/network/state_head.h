// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "diffusion/denoiser.h"
#include "diffusion/network/architecture.h"
#include "inference/unet_layers.h"

namespace cdiff::diffusion {

/// The state head (docs/neural_network.md): [actions; v / 10; time embedding] -> states [B, T, 4],
/// and its backward pass to the actions. The first layer's time columns are tabulated at load, its
/// speed column is added once per set of contexts.
class StateHead {
 public:
  /// `time_embeddings`: [K + 1, time_width].
  StateHead(const inference::DenoiserKernels& kernels, const Architecture& architecture,
            const inference::Tensors& tensors, const inference::Activation& time_embeddings);

  void setContexts(const std::vector<Context>& contexts);
  void forward(const float* actions, int k, float* states);
  void backward(const float* state_gradient, float* action_gradient);

 private:
  /// A hidden layer: value before Mish, after it, and Mish'; the gradient overwrites none of them.
  struct Hidden {
    inference::Activation input;
    inference::Activation value;
    inference::Activation slope;
    inference::Activation gradient;

    Hidden() = default;
    Hidden(std::int64_t width, std::int64_t rows);
  };
  void mish(Hidden& hidden) const;

  const inference::DenoiserKernels* kernels_;
  std::int64_t action_values_;  ///< T x 3
  std::int64_t state_values_;   ///< T x 4
  std::int64_t width_;
  inference::Convolution actions_, actions_reversed_;
  std::optional<inference::Convolution> speed_;  ///< empty where it is no input
  inference::Convolution middle_, middle_reversed_;
  inference::Convolution out_, out_reversed_;
  inference::Activation time_part_;   ///< [K + 1, width], with the bias
  inference::Activation speed_part_;  ///< [B, width]
  inference::Activation action_rows_, state_rows_;
  Hidden hidden_[2];
};

}  // namespace cdiff::diffusion
