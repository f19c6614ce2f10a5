// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/encoder_convolution.h"

#include <cstring>

namespace cdiff::inference {
namespace {

using Tag = dnnl::memory::format_tag;
constexpr auto kFloat = dnnl::memory::data_type::f32;

std::int64_t outputSide(std::int64_t side, std::int64_t kernel, const ConvolutionOptions& options) {
  return (side + 2 * options.padding - kernel) / options.stride + 1;
}

MapShape outputShape(const MapShape& input, std::int64_t channels, std::int64_t kernel,
                     const ConvolutionOptions& options) {
  return {channels, outputSide(input.height, kernel, options),
          outputSide(input.width, kernel, options)};
}

/// Scratch memory of its own, so that encoders in different threads share nothing; full float32
/// whatever the environment asks for.
dnnl::primitive_attr attributes(bool relu) {
  dnnl::primitive_attr attributes;
  attributes.set_fpmath_mode(dnnl::fpmath_mode::strict);
  attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);
  if (!relu) return attributes;
  dnnl::post_ops operations;
  operations.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
  attributes.set_post_ops(operations);
  return attributes;
}

dnnl::convolution_forward::primitive_desc describe(const dnnl::engine& engine,
                                                   const dnnl::memory::desc& source,
                                                   const dnnl::memory::desc& destination,
                                                   const ConvolutionOptions& options,
                                                   const Tensor& weight, bool bias) {
  const dnnl::memory::dims strides = {options.stride, options.stride};
  const dnnl::memory::dims padding = {options.padding, options.padding};
  const dnnl::memory::desc weights(weight.shape, kFloat, Tag::any);
  const auto kind = dnnl::prop_kind::forward_inference;
  const auto direct = dnnl::algorithm::convolution_direct;
  if (!bias) {
    return {{kind, direct, source, weights, destination, strides, padding, padding},
            attributes(false),
            engine};
  }
  const dnnl::memory::desc biases({weight.shape[0]}, kFloat, Tag::a);
  return {{kind, direct, source, weights, biases, destination, strides, padding, padding},
          attributes(true),
          engine};
}

}  // namespace

EncoderConvolution::EncoderConvolution(const dnnl::engine& engine, const MapShape& input,
                                       Tag layout, const ConvolutionOptions& options,
                                       const Tensor& weight, const Tensor* bias)
    : output_(inference::outputShape(input, weight.shape[0], weight.shape[2], options)),
      description_(
          describe(engine, mapDescription(input, input.channels < 8 ? imageLayout(layout) : layout),
                   mapDescription(output_, layout), options, weight, bias != nullptr)),
      primitive_(description_) {
  loadWeights(engine, weight, bias);
}

void EncoderConvolution::loadWeights(const dnnl::engine& engine, const Tensor& weight,
                                     const Tensor* bias) {
  dnnl::stream stream(engine);
  const dnnl::memory plain({weight.shape, kFloat, Tag::oihw}, engine,
                           const_cast<float*>(weight.values.data()));
  dnnl::memory reordered(description_.weights_desc(), engine);
  dnnl::reorder(plain, reordered).execute(stream, const_cast<dnnl::memory&>(plain), reordered);
  stream.wait();
  arguments_[DNNL_ARG_WEIGHTS] = reordered;
  if (bias == nullptr) return;
  const dnnl::memory biases(description_.bias_desc(), engine);
  std::memcpy(biases.get_data_handle(), bias->values.data(), bias->values.size() * sizeof(float));
  arguments_[DNNL_ARG_BIAS] = biases;
}

void EncoderConvolution::bind(const dnnl::engine& engine, void* source, void* destination,
                              void* scratchpad) {
  arguments_[DNNL_ARG_SRC] = dnnl::memory(description_.src_desc(), engine, source);
  arguments_[DNNL_ARG_DST] = dnnl::memory(description_.dst_desc(), engine, destination);
  arguments_[DNNL_ARG_SCRATCHPAD] =
      dnnl::memory(description_.scratchpad_desc(), engine, scratchpad);
}

EncoderPooling::EncoderPooling(const dnnl::engine& engine, const MapShape& input, Tag layout)
    : output_(inference::outputShape(input, input.channels, 3, {2, 1})),
      description_({dnnl::prop_kind::forward_inference,
                    dnnl::algorithm::pooling_max,
                    mapDescription(input, layout),
                    mapDescription(output_, layout),
                    {2, 2},
                    {3, 3},
                    {1, 1},
                    {1, 1}},
                   engine),
      primitive_(description_) {}

void EncoderPooling::bind(const dnnl::engine& engine, void* source, void* destination) {
  arguments_[DNNL_ARG_SRC] = dnnl::memory(description_.src_desc(), engine, source);
  arguments_[DNNL_ARG_DST] = dnnl::memory(description_.dst_desc(), engine, destination);
}

}  // namespace cdiff::inference
