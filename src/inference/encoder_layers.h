// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <oneapi/dnnl/dnnl.hpp>
#include <unordered_map>
#include <vector>

#include "inference/encoder_kernels.h"
#include "inference/precision.h"
#include "inference/safetensors.h"

namespace cdiff::inference {

// Feature maps of one image in oneDNN memory, float32, [1, channels, height, width] stored channels
// last or in blocks of 8 or 16 channels, whichever this machine's convolutions work best on.

/// Shape [channels, height, width] of a feature map.
struct MapShape {
  std::int64_t channels = 0;
  std::int64_t height = 0;
  std::int64_t width = 0;

  std::int64_t pixels() const { return height * width; }
  std::int64_t size() const { return channels * pixels(); }
};

/// Layout that a 3x3 convolution prefers here: nhwc, nChw8c or nChw16c. In float32 not that of
/// oneDNN's brgemm kernels (nhwc): they split their sums by the sizes of the caches, so that two
/// processors of one instruction set would come to other bytes. Sums of bytes are exact.
dnnl::memory::format_tag preferredLayout(const dnnl::engine& engine,
                                         Precision precision = Precision::kFp32);

/// The plain layout in which the first convolution reads the image's three channels.
dnnl::memory::format_tag imageLayout(dnnl::memory::format_tag layout);

dnnl::memory::desc mapDescription(const MapShape& shape, dnnl::memory::format_tag layout,
                                  dnnl::memory::data_type type = dnnl::memory::data_type::f32);

/// Where channel c of a pixel lies: block (c / width) x block_stride + pixel x pixel_stride + c %
/// width, in floats; only the strides depend on the layout.
struct ChannelBlocks {
  std::int64_t width = 16;  ///< channels side by side: 8 or 16
  std::int64_t block_stride = 0;
  std::int64_t pixel_stride = 0;

  ChannelBlocks(const MapShape& shape, dnnl::memory::format_tag layout);
};

/// While one lives, oneDNN computes on the calling thread alone.
class OneThread {
 public:
  OneThread();
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

/// Group normalization of the image encoder in groups of 16 channels, fused with the residual sum
/// and the ReLU that follow: y = max(0, (x - mean) / sqrt(variance + 1e-5) gain + shift +
/// residual).
class EncoderNorm {
 public:
  static constexpr std::int64_t kGroup = 16;  ///< channels

  /// `gain` and `shift` are [channels], a multiple of 16.
  EncoderNorm(const MapShape& shape, dnnl::memory::format_tag layout, const Tensor& gain,
              const Tensor& shift, InstructionSet instruction_set = bestInstructionSet());

  enum class Activation { kNone, kRelu };
  /// In place, of x = map x `unit`; `residual` (same layout, or nullptr) is added. Sums run in a
  /// fixed order. Returns the largest y.
  float run(float* map, const float* residual, Activation activation, double unit = 1.0) const;

 private:
  using Lanes = std::array<double, kGroup>;  ///< a number per channel of a group

  ChannelRun runOf(float* map, std::int64_t block) const;
  /// Sum over pixels of (x - mean), or of its square, over a group.
  double sum(float* map, std::int64_t group, float mean, bool squared) const;
  /// Scale and offset of a group's channels.
  void scaleGroup(float* map, std::int64_t group, double unit, float* scale, float* offset) const;

  std::int64_t pixels_;
  std::int64_t channels_;
  ChannelBlocks blocks_;
  const EncoderKernels* kernels_;
  std::vector<float> gain_;
  std::vector<float> shift_;
};

/// A feature map as the convolutions of a precision read it: the map itself, or a copy in bfloat16
/// or in bytes, x = byte x unit. The unit follows from the largest value of each map, so that
/// nothing has to be calibrated; maps are not negative.
class ConvolutionInput {
 public:
  /// Holds up to `largest_size` values.
  ConvolutionInput(Precision precision, std::int64_t largest_size,
                   InstructionSet instruction_set = bestInstructionSet());

  /// Where a convolution of `map` reads.
  void* data(float* map);
  /// Copies `size` values, the largest of which is `largest`.
  void update(const float* map, std::int64_t size, float largest);
  double unit() const { return unit_; }  ///< 1 unless bytes are read

 private:
  Precision precision_;
  const EncoderKernels* kernels_;
  std::vector<std::uint16_t> halves_;
  std::vector<std::uint8_t> bytes_;
  double unit_ = 1.0;
};

/// Stride and padding of a two-dimensional convolution [pixels], and in which numbers it
/// multiplies.
struct ConvolutionOptions {
  std::int64_t stride = 1;
  std::int64_t padding = 0;
  Precision precision = Precision::kFp32;
};

/// A convolution of the image encoder by oneDNN: weights reordered once into the form that its
/// kernel wants; zero padding, square kernel, bias with ReLU or neither. Of bytes it gives float32
/// in units of its ConvolutionInput; its weights are rounded to 127 steps per output channel.
class EncoderConvolution {
 public:
  /// `weight` is [out, in, kernel, kernel]; with a `bias` [out] a ReLU follows (fp32 alone). An
  /// input of less than 8 channels comes in imageLayout(layout), all else in `layout`.
  EncoderConvolution(const dnnl::engine& engine, const MapShape& input,
                     dnnl::memory::format_tag layout, const ConvolutionOptions& options,
                     const Tensor& weight, const Tensor* bias = nullptr);

  const MapShape& outputShape() const { return output_; }
  std::size_t scratchpadBytes() const { return description_.scratchpad_desc().get_size(); }
  /// Fixes where run() reads and writes; `scratchpad` holds at least scratchpadBytes().
  void bind(const dnnl::engine& engine, void* source, void* destination, void* scratchpad);
  void run(dnnl::stream& stream) const { primitive_.execute(stream, arguments_); }

 private:
  void loadWeights(const dnnl::engine& engine, const Tensor& weight, const Tensor* bias,
                   Precision precision);

  MapShape output_;
  dnnl::convolution_forward::primitive_desc description_;
  dnnl::convolution_forward primitive_;
  std::unordered_map<int, dnnl::memory> arguments_;
};

/// Max pooling 3x3, stride 2, padding 1.
class EncoderPooling {
 public:
  EncoderPooling(const dnnl::engine& engine, const MapShape& input,
                 dnnl::memory::format_tag layout);

  const MapShape& outputShape() const { return output_; }
  void bind(const dnnl::engine& engine, void* source, void* destination);
  void run(dnnl::stream& stream) const { primitive_.execute(stream, arguments_); }

 private:
  MapShape output_;
  dnnl::pooling_forward::primitive_desc description_;
  dnnl::pooling_forward primitive_;
  std::unordered_map<int, dnnl::memory> arguments_;
};

}  // namespace cdiff::inference
