// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>

namespace cdiff::inference {

/// Channels of every activation are padded with zeros to a multiple of this.
inline constexpr std::int64_t kChannelMultiple = 16;

/// Rows of channels in memory.
struct View {
  float* data = nullptr;
  std::int64_t row = 0;  ///< floats from one row to the next
};

/// output[r, o] = bias[o] (or, accumulating, output[r, o]) + sum over taps j and inputs i of
/// weights[j, i, o] input[row r, tap j, i].
struct ConvolutionCall {
  const float* weights = nullptr;  ///< [block of outputs][tap][input][output of the block]
  const float* bias = nullptr;     ///< [outputs]
  std::int64_t inputs = 0;
  std::int64_t taps = 0;
  std::int64_t outputs = 0;  ///< multiple of kChannelMultiple
  View input;                ///< first tap of row 0
  std::int64_t tap = 0;      ///< floats from one tap to the next
  View output;
  std::int64_t rows = 0;
  bool accumulate = false;
};

/// Group normalization of `groups` x `group_channels` channels, then padding up to `channels`.
struct NormalizationShape {
  std::int64_t channels = 0;
  std::int64_t groups = 0;
  std::int64_t group_channels = 0;
  std::int64_t rows = 0;
  float* scratch = nullptr;  ///< [3, channels]
};

/// output = Mish(scale n + shift) + added, with n = (x - mean) / sqrt(variance + 1e-5) by group.
struct NormalizationCall {
  NormalizationShape shape;
  const float* scale = nullptr;        ///< [channels], 0 in the padding
  const float* shift = nullptr;        ///< [channels], 0 in the padding
  View normalized;                     ///< x, replaced by n
  View slope;                          ///< result: Mish'(scale n + shift) scale
  float* inverse_deviation = nullptr;  ///< result: [channels]
  View added;
  View output;
};

/// input_gradient = (d output / d x)^T output_gradient of a NormalizationCall.
struct NormalizationGradientCall {
  NormalizationShape shape;
  View normalized;
  View slope;
  const float* inverse_deviation = nullptr;  ///< [channels]
  View output_gradient;
  View input_gradient;
};

/// The arithmetic of the denoiser's layers for one instruction set, one sample at a time: float32,
/// activations stored [time][channel]. The order of operations of an output element is fixed and
/// does not depend on how rows are tiled.
struct DenoiserKernels {
  std::int64_t block = 0;  ///< outputs of a full block of packed weights
  void (*convolve)(const ConvolutionCall& call);
  void (*normalize)(const NormalizationCall& call);
  void (*backwardNormalize)(const NormalizationGradientCall& call);
  /// output = Mish(input), slope = Mish'(input); `count` is a multiple of kChannelMultiple.
  void (*mish)(const float* input, std::int64_t count, float* output, float* slope);
};

/// nullptr where the compiler does not know the instruction set.
const DenoiserKernels* plainKernels();
const DenoiserKernels* avx2Kernels();
const DenoiserKernels* avx512Kernels();

}  // namespace cdiff::inference
