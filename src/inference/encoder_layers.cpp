// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/encoder_layers.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace cdiff::inference {

using Tag = dnnl::memory::format_tag;

Tag preferredLayout(const dnnl::engine& engine) {
  const OneThread one_thread;
  const auto type = dnnl::memory::data_type::f32;
  const dnnl::memory::desc map({1, 64, 24, 40}, type, Tag::any);
  const dnnl::memory::desc weights({64, 64, 3, 3}, type, Tag::any);
  const dnnl::convolution_forward::desc description(dnnl::prop_kind::forward_inference,
                                                    dnnl::algorithm::convolution_direct, map,
                                                    weights, map, {1, 1}, {1, 1}, {1, 1});
  const dnnl::memory::desc chosen =
      dnnl::convolution_forward::primitive_desc(description, engine).dst_desc();
  for (const Tag tag : {Tag::nChw16c, Tag::nChw8c}) {
    if (chosen == dnnl::memory::desc({1, 64, 24, 40}, type, tag)) return tag;
  }
  return Tag::nhwc;
}

Tag imageLayout(Tag layout) { return layout == Tag::nhwc ? Tag::nhwc : Tag::nchw; }

dnnl::memory::desc mapDescription(const MapShape& shape, Tag layout) {
  return dnnl::memory::desc({1, shape.channels, shape.height, shape.width},
                            dnnl::memory::data_type::f32, layout);
}

ChannelBlocks::ChannelBlocks(const MapShape& shape, Tag layout)
    : width(layout == Tag::nChw8c ? 8 : 16),
      block_stride(layout == Tag::nhwc ? width : width * shape.pixels()),
      pixel_stride(layout == Tag::nhwc ? shape.channels : width) {}

OneThread::OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }

OneThread::~OneThread() { omp_set_num_threads(before_); }

namespace {

constexpr double kEpsilon = 1e-5;
constexpr std::int64_t kRun = 64;  ///< pixels that are summed in float before they go into a double

}  // namespace

EncoderNorm::EncoderNorm(const MapShape& shape, dnnl::memory::format_tag layout, const Tensor& gain,
                         const Tensor& shift)
    : pixels_(shape.pixels()),
      channels_(shape.channels),
      blocks_(shape, layout),
      gain_(gain.values),
      shift_(shift.values) {}

void EncoderNorm::run(float* map, const float* residual, Activation activation) const {
  if (blocks_.width == 8) {
    runGroups<8>(map, residual, activation);
  } else {
    runGroups<16>(map, residual, activation);
  }
}

template <int kWidth>
void EncoderNorm::runGroups(float* map, const float* residual, Activation activation) const {
  const double count = static_cast<double>(kGroup * pixels_);
  const float floor =
      activation == Activation::kRelu ? 0.0F : -std::numeric_limits<float>::infinity();
  for (std::int64_t group = 0; group < channels_ / kGroup; ++group) {
    const Lanes sum = sums<kWidth, false>(map, group, 0.0F);
    const double mean = std::accumulate(sum.begin(), sum.end(), 0.0) / count;
    const Lanes squares = sums<kWidth, true>(map, group, static_cast<float>(mean));
    const double variance = std::accumulate(squares.begin(), squares.end(), 0.0) / count;
    const double inverse = 1.0 / std::sqrt(variance + kEpsilon);
    for (std::int64_t part = 0; part < kGroup / kWidth; ++part) {
      const std::int64_t block = group * (kGroup / kWidth) + part;
      float scale[kWidth];
      float offset[kWidth];
      for (int lane = 0; lane < kWidth; ++lane) {
        const std::size_t channel = static_cast<std::size_t>(block * kWidth + lane);
        scale[lane] = static_cast<float>(gain_[channel] * inverse);
        offset[lane] = static_cast<float>(shift_[channel] - mean * inverse * gain_[channel]);
      }
      float* values = map + block * blocks_.block_stride;
      if (residual == nullptr) {
        applyBlock<kWidth, false>(values, nullptr, scale, offset, floor);
      } else {
        applyBlock<kWidth, true>(values, residual + block * blocks_.block_stride, scale, offset,
                                 floor);
      }
    }
  }
}

template <int kWidth, bool kSquared>
EncoderNorm::Lanes EncoderNorm::sums(const float* map, std::int64_t group, float mean) const {
  Lanes total{};
  for (std::int64_t part = 0; part < kGroup / kWidth; ++part) {
    const float* values = map + (group * (kGroup / kWidth) + part) * blocks_.block_stride;
    for (std::int64_t begin = 0; begin < pixels_; begin += kRun) {
      const std::int64_t end = std::min(begin + kRun, pixels_);
      float sum[kWidth] = {};
      for (std::int64_t pixel = begin; pixel < end; ++pixel) {
        const float* row = values + pixel * blocks_.pixel_stride;
        for (int lane = 0; lane < kWidth; ++lane) {
          const float deviation = row[lane] - mean;
          sum[lane] += kSquared ? deviation * deviation : deviation;
        }
      }
      for (int lane = 0; lane < kWidth; ++lane)
        total[static_cast<std::size_t>(part * kWidth + lane)] += static_cast<double>(sum[lane]);
    }
  }
  return total;
}

template <int kWidth, bool kResidual>
void EncoderNorm::applyBlock(float* map, const float* residual, const float* scale,
                             const float* offset, float floor) const {
  for (std::int64_t pixel = 0; pixel < pixels_; ++pixel) {
    float* row = map + pixel * blocks_.pixel_stride;
    float sum[kWidth];
    for (int lane = 0; lane < kWidth; ++lane) sum[lane] = row[lane] * scale[lane] + offset[lane];
    if constexpr (kResidual) {
      const float* other = residual + pixel * blocks_.pixel_stride;
      for (int lane = 0; lane < kWidth; ++lane) sum[lane] += other[lane];
    }
    for (int lane = 0; lane < kWidth; ++lane) row[lane] = sum[lane] > floor ? sum[lane] : floor;
  }
}

namespace {

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
