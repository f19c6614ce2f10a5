// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What conditions the denoiser (docs/network.md): time embedding of k and context c of each
/// sample. The linear injection of Mish([time; c]) is split by columns: its time part is tabulated
/// for every k at load, its context part computed once per set of contexts.
#pragma once

#include <vector>

#include "activation.h"
#include "e2e_cdiff/diffusion/denoiser.h"
#include "unet.h"

namespace cdiff::diffusion {

class Conditioning {
 public:
  Conditioning(const DenoiserKernels& kernels, const Architecture& architecture,
               const Tensors& tensors, const std::vector<Injection>& injections);

  /// Throws std::invalid_argument for features or tokens of another size.
  void setContexts(const std::vector<Context>& contexts);
  /// A row for each sample at step k = 1..K; valid until the next call.
  View injection(int k);
  /// [K + 1, time_width].
  const Activation& timeEmbeddings() const { return time_; }

 private:
  struct Layers {
    Convolution route0, route2, speed0, context0;
  };
  void buildTimeEmbeddings(const Tensors& tensors);
  void buildInjections(const Tensors& tensors, const std::vector<Injection>& injections);
  void requireSizes(const Context& context, std::size_t sample) const;
  /// A matrix with Mish applied to each element.
  Activation mished(const Activation& input) const;
  /// Rows of route features.
  Activation routeFeatures(const std::vector<Context>& contexts) const;
  Activation speedFeatures(const std::vector<Context>& contexts) const;

  const DenoiserKernels* kernels_;
  Architecture architecture_;
  Layers layers_;
  std::vector<float> no_route_;
  Activation time_;
  struct ContextInjection {
    std::int64_t first;
    Convolution layer;
  };
  std::vector<ContextInjection> context_injections_;
  Activation time_part_;     ///< [K + 1, injections], with the biases
  Activation context_part_;  ///< [B, injections]
  Activation injection_;     ///< [B, injections]
};

}  // namespace cdiff::diffusion
