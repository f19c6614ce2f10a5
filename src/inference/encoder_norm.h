// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Group normalisation of the image encoder in groups of 16 channels, fused with the residual sum
/// and the ReLU that follow: y = max(0, (x - mean) / sqrt(variance + 1e-5) gain + shift +
/// residual).
#pragma once

#include <array>
#include <vector>

#include "inference/encoder_map.h"
#include "inference/safetensors.h"

namespace cdiff::inference {

class EncoderNorm {
 public:
  static constexpr std::int64_t kGroup = 16;  ///< channels

  /// `gain` and `shift` are [channels], a multiple of 16.
  EncoderNorm(const MapShape& shape, dnnl::memory::format_tag layout, const Tensor& gain,
              const Tensor& shift);

  enum class Activation { kNone, kRelu };
  /// In place; `residual` (same layout, or nullptr) is added. Sums run in a fixed order.
  void run(float* map, const float* residual, Activation activation) const;

 private:
  using Lanes = std::array<double, kGroup>;  ///< a number per channel of a group

  template <int kWidth>
  void runGroups(float* map, const float* residual, Activation activation) const;
  /// Sum over pixels of (x - mean), or of its square, per channel of a group.
  template <int kWidth, bool kSquared>
  Lanes sums(const float* map, std::int64_t group, float mean) const;
  /// y = x scale + offset (+ residual) of one block of channels.
  template <int kWidth, bool kResidual>
  void applyBlock(float* map, const float* residual, const float* scale, const float* offset,
                  float floor) const;

  std::int64_t pixels_;
  std::int64_t channels_;
  ChannelBlocks blocks_;
  std::vector<float> gain_;
  std::vector<float> shift_;
};

}  // namespace cdiff::inference
