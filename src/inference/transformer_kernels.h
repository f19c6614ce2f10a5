// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>

#include "inference/denoiser_kernels.h"

namespace cdiff::inference {

/// output = (z - mean) / sqrt(variance + 1e-5) gain + shift with z = input + added, row by row.
struct LayerNormCall {
  std::int64_t channels = 0;  ///< multiple of kChannelMultiple
  std::int64_t rows = 0;
  const float* gain = nullptr;   ///< [channels]
  const float* shift = nullptr;  ///< [channels]
  View input;
  View added;  ///< rows of stride 0: the same for all
  View output;
};

/// Scaled dot-product attention of one sequence (Vaswani et al. 2017): output_h = softmax(Q_h K_h^T
/// / sqrt(head_width)) V_h for each head h, the heads side by side in each row.
struct AttentionCall {
  std::int64_t heads = 0;
  std::int64_t head_width = 0;  ///< multiple of kChannelMultiple
  std::int64_t queries = 0;     ///< rows of `query` and `output`
  std::int64_t keys = 0;        ///< rows of `key` and `value`
  View query;
  View key;
  View value;
  View output;
  float* weights = nullptr;  ///< result: softmax [heads, queries, paddedKeys(keys)]
  float* scratch = nullptr;  ///< [head_width, paddedKeys(keys)]
};

/// Floats from one row of attention weights to the next.
inline std::int64_t paddedKeys(std::int64_t keys) {
  return (keys + kChannelMultiple - 1) / kChannelMultiple * kChannelMultiple;
}

/// The arithmetic of a transformer's layers for one instruction set beside the linear layers, which
/// are DenoiserKernels::convolve: float32. A row's result does not depend on other rows but those
/// that it attends to.
struct TransformerKernels {
  void (*normalizeRows)(const LayerNormCall& call);
  void (*attend)(const AttentionCall& call);
  /// x (1 + erf(x / sqrt 2)) / 2 in place; `count` is a multiple of kChannelMultiple.
  void (*gelu)(float* values, std::int64_t count);
};

/// nullptr where the compiler does not know the instruction set.
const TransformerKernels* plainTransformerKernels();
const TransformerKernels* avx2TransformerKernels();
const TransformerKernels* avx512TransformerKernels();

}  // namespace cdiff::inference
