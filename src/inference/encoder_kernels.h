// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>

namespace cdiff::inference {

/// `width` (8 or 16) channels that lie side by side, of every pixel of a feature map.
struct ChannelRun {
  float* data = nullptr;
  std::int64_t width = 0;
  std::int64_t pixels = 0;
  std::int64_t pixel_stride = 0;  ///< floats from one pixel to the next
};

/// x = max(floor, x scale + offset + residual) of a ChannelRun.
struct NormLine {
  const float* scale = nullptr;     ///< [width]
  const float* offset = nullptr;    ///< [width]
  const float* residual = nullptr;  ///< laid out as the run, or nullptr
  float floor = 0.0F;
};

/// What lies between two convolutions of an image encoder, for one instruction set. Products are
/// rounded before sums, and the sums of a channel run in one order, so that all instruction sets
/// give the same bytes.
struct EncoderKernels {
  /// lanes[width] = sum over pixels of x - mean, or of its square; 64 pixels at a time are summed
  /// in float32, these sums in double.
  void (*sums)(const ChannelRun& run, float mean, bool squared, double* lanes);
  /// In place; returns the largest result.
  float (*apply)(const ChannelRun& run, const NormLine& line);
  /// byte = x factor rounded to the nearest integer, within 0 and 255; `count` is a multiple of 16.
  void (*toBytes)(const float* values, std::int64_t count, float factor, std::uint8_t* bytes);
  /// The nearest bfloat16, of two equally near ones the even one; `count` is a multiple of 16.
  void (*toBfloat16)(const float* values, std::int64_t count, std::uint16_t* halves);
};

/// nullptr where the compiler does not know the instruction set.
const EncoderKernels* plainEncoderKernels();
const EncoderKernels* avx2EncoderKernels();
const EncoderKernels* avx512EncoderKernels();

}  // namespace cdiff::inference
