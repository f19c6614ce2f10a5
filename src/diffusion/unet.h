// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The action head: the temporal U-Net tau^k [B, T, 7] -> actions [B, T, 3] and its pull-back
/// (docs/network.md).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/diffusion/architecture.h"
#include "unet_layers.h"

namespace cdiff::diffusion {

/// What a residual block takes of the conditioning.
struct Injection {
  std::string name;  ///< of the linear layer
  ChannelLayout layout;
  std::int64_t first = 0;  ///< its first channel in a row of injections
};

class UNet {
 public:
  UNet(const DenoiserKernels& kernels, const Architecture& architecture, const Tensors& tensors);

  /// In the order of their channels.
  const std::vector<Injection>& injections() const { return injections_; }
  void resize(std::int64_t samples);
  /// `injection`: a row of injections for each sample.
  void forward(const float* noisy, const View& injection, float* actions);
  void pullBack(const float* action_gradient, float* noisy_gradient);

 private:
  const Signal* addSignal(const ChannelLayout& layout, std::int64_t rows);
  void addBlock(const std::string& name, const ChannelLayout& inputs, const Connection& connection);
  /// R(inputs -> channels) from `connection.input`, R(channels -> channels) to `connection.output`.
  void addBlockPair(const std::string& name, const ChannelLayout& inputs,
                    const Connection& connection);
  void addLevels(const Architecture& architecture);
  /// Sampling down after a level, or up.
  void addSampling(const std::string& name, const Connection& connection, bool up);
  void addHead(const ChannelLayout& layout);

  LayerSource source_;
  std::int64_t horizon_;
  std::int64_t samples_ = 0;
  std::vector<std::unique_ptr<Signal>> signals_;
  std::vector<std::unique_ptr<Layer>> layers_;
  std::vector<Injection> injections_;
  const Signal* noisy_ = nullptr;
  const Signal* actions_ = nullptr;
  const Signal* head_input_ = nullptr;
};

}  // namespace cdiff::diffusion
