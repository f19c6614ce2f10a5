// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A convolution over time with its weights packed for the kernels: gathering, output[s] = bias +
/// sum over k of W_k input[stride s + k - padding], or spreading (a transposed convolution),
/// output[stride s + k - padding] += W_k input[s]. One is the pull-back of the other.
#pragma once

#include <cstdint>
#include <vector>

#include "inference/activation.h"
#include "inference/denoiser_kernels.h"
#include "inference/safetensors.h"

namespace cdiff::inference {

/// Weights as they lie in a tensor: W_k[o, i] = values[o output_stride + i input_stride + k].
struct Filter {
  const float* values = nullptr;
  ChannelLayout outputs;
  ChannelLayout inputs;
  std::int64_t output_stride = 0;
  std::int64_t input_stride = 0;
  std::int64_t taps = 1;

  /// Of a convolution [out, in, kernel], a transposed one [in, out, kernel], and of the columns
  /// first .. first + inputs - 1 of a linear layer [out, in].
  static Filter ofConvolution(const Tensor& weight);
  static Filter ofTransposedConvolution(const Tensor& weight);
  static Filter ofLinear(const Tensor& weight, std::int64_t first, std::int64_t inputs);
  static Filter ofLinear(const Tensor& weight);
  Filter transposed() const;
};

struct Spacing {
  std::int64_t stride = 1;
  std::int64_t padding = 0;
  bool spread = false;

  Spacing reversed() const { return {stride, padding, !spread}; }
};

class Convolution {
 public:
  /// Without `bias` it is zero.
  Convolution(const DenoiserKernels& kernels, const Filter& filter, const Spacing& spacing,
              const Tensor* bias = nullptr);

  /// The input has rows / stride (spreading) or rows x stride rows.
  void apply(const View& input, const View& output, std::int64_t rows,
             bool accumulate = false) const;
  /// Of matrices: every row by itself.
  void applyToRows(const Activation& input, const Activation& output,
                   bool accumulate = false) const;
  /// With padding.
  std::int64_t outputs() const { return outputs_; }

 private:
  /// The output rows phase, phase + output_stride, ... and the taps that reach them.
  struct Phase {
    std::int64_t first = 0;  ///< input row of the first tap for the first output row
    std::int64_t taps = 0;
    AlignedFloats weights;
  };
  /// Packs the taps k = ks[0], ks[1], ...
  AlignedFloats pack(const Filter& filter, const std::vector<std::int64_t>& ks) const;

  const DenoiserKernels* kernels_;
  Spacing spacing_;
  std::int64_t inputs_;
  std::int64_t outputs_;
  AlignedFloats bias_;
  std::vector<Phase> phases_;
};

}  // namespace cdiff::inference
