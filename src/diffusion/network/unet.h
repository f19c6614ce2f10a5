// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diffusion/denoiser.h"
#include "diffusion/network/architecture.h"
#include "inference/unet_layers.h"

namespace cdiff::diffusion {

/// What a residual block takes of the conditioning.
struct Injection {
  std::string name;  ///< name of the linear layer
  inference::ChannelLayout layout;
  std::int64_t first = 0;  ///< its first channel in a row of injections
};

/// The action head: the temporal U-Net tau^k [B, T, 7] -> actions [B, T, 3] and its backward pass
/// (docs/neural_network.md). Where the architecture pins the current state, rows of it, (0, 0, 0, v
/// / 10) without action, are written before tau^k at every forward pass; no gradient leaves through
/// them.
class UNet {
 public:
  UNet(const inference::DenoiserKernels& kernels, const Architecture& architecture,
       const inference::Tensors& tensors);

  /// In the order of their channels.
  const std::vector<Injection>& injections() const { return parts_.injections; }
  void setContexts(const std::vector<Context>& contexts);
  /// `injection`: a row of injections for each sample.
  void forward(const float* noisy, const inference::Activation& injection, float* actions);
  void backward(const float* action_gradient, float* noisy_gradient);

 private:
  friend class UNetBuilder;
  struct Parts {
    std::vector<std::unique_ptr<inference::Variable>> variables;
    std::vector<std::unique_ptr<inference::Layer>> layers;  ///< in the order of the forward pass
    std::vector<Injection> injections;
    const inference::Variable* noisy = nullptr;
    const inference::Variable* actions = nullptr;
  };

  void writeCurrentState(std::int64_t sample);

  std::int64_t horizon_;
  std::int64_t pinned_rows_;
  std::int64_t samples_ = 0;
  std::vector<float> speeds_;  ///< v / 10, by sample
  Parts parts_;
};

}  // namespace cdiff::diffusion
