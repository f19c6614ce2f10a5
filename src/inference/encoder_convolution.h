// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A convolution of the image encoder by oneDNN: weights reordered once into the form that its
/// kernel wants; zero padding, square kernel, bias with ReLU or neither.
#pragma once

#include <unordered_map>

#include "inference/encoder_map.h"
#include "inference/safetensors.h"

namespace cdiff::inference {

struct ConvolutionOptions {
  std::int64_t stride = 1;
  std::int64_t padding = 0;
};

class EncoderConvolution {
 public:
  /// `weight` is [out, in, kernel, kernel]; with a `bias` [out] a ReLU follows. An input of less
  /// than 8 channels comes in imageLayout(layout), all else in `layout`.
  EncoderConvolution(const dnnl::engine& engine, const MapShape& input,
                     dnnl::memory::format_tag layout, const ConvolutionOptions& options,
                     const Tensor& weight, const Tensor* bias = nullptr);

  const MapShape& outputShape() const { return output_; }
  std::size_t scratchpadBytes() const { return description_.scratchpad_desc().get_size(); }
  /// Fixes where run() reads and writes; `scratchpad` holds at least scratchpadBytes().
  void bind(const dnnl::engine& engine, void* source, void* destination, void* scratchpad);
  void run(dnnl::stream& stream) const { primitive_.execute(stream, arguments_); }

 private:
  void loadWeights(const dnnl::engine& engine, const Tensor& weight, const Tensor* bias);

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
