// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "diffusion/denoiser.h"
#include "diffusion/network/unet.h"
#include "inference/convolution.h"

namespace cdiff::diffusion {

/// What conditions the denoiser (docs/neural_network.md): time embedding of k and context c of each
/// sample. The linear injection of Mish([time; c]) is split by columns: its time part is tabulated
/// for every k at load, its context part computed once per set of contexts.
class Conditioning {
 public:
  Conditioning(const inference::DenoiserKernels& kernels, const Architecture& architecture,
               const inference::Tensors& tensors, const std::vector<Injection>& injections);

  /// Throws std::invalid_argument for features or tokens of another size, and for a route, an image
  /// before or a target speed that the architecture does not take.
  void setContexts(const std::vector<Context>& contexts);
  /// A row for each sample at step k = 1..K; valid until the next call.
  const inference::Activation& injection(int k);
  /// [K + 1, time_width].
  const inference::Activation& timeEmbeddings() const { return time_; }

 private:
  using Layer = std::optional<inference::Convolution>;  ///< empty where the architecture has none
  void buildTimeEmbeddings(const inference::Tensors& tensors);
  void buildInjections(const inference::Tensors& tensors, const std::vector<Injection>& injections);
  void requireSizes(const Context& context, std::size_t sample) const;
  /// A matrix with Mish applied to each element.
  inference::Activation mished(const inference::Activation& input) const;
  /// Rows of route features.
  inference::Activation routeFeatures(const std::vector<Context>& contexts) const;
  inference::Activation speedFeatures(const std::vector<Context>& contexts) const;
  inference::Activation previousFeatures(const std::vector<Context>& contexts) const;
  inference::Activation targetFeatures(const std::vector<Context>& contexts) const;
  /// Rows of [image features; route; speed; image before; target speed], as far as the
  /// architecture takes them.
  inference::Activation joinedFeatures(const std::vector<Context>& contexts) const;

  const inference::DenoiserKernels* kernels_;
  Architecture architecture_;
  Layer route0_, route2_, speed0_, target0_, context0_;
  std::vector<float> no_route_, no_previous_, no_target_;
  inference::Activation time_;
  struct ContextInjection {
    std::int64_t first;
    inference::Convolution layer;
  };
  std::vector<ContextInjection> context_injections_;
  inference::Activation time_part_;     ///< [K + 1, injections], with the biases
  inference::Activation context_part_;  ///< [B, injections]
  inference::Activation injection_;     ///< [B, injections]
};

}  // namespace cdiff::diffusion
