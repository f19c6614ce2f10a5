// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/encoder_layers.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <string_view>

namespace cdiff::inference {

using Tag = dnnl::memory::format_tag;

Tag preferredLayout(const dnnl::engine& engine, Precision precision) {
  if (precision != Precision::kFp32) return Tag::nhwc;
  const OneThread one_thread;
  const auto type = dnnl::memory::data_type::f32;
  const dnnl::memory::desc map({1, 64, 24, 40}, type, Tag::any);
  const dnnl::memory::desc weights({64, 64, 3, 3}, type, Tag::any);
  const dnnl::convolution_forward::desc description(dnnl::prop_kind::forward_inference,
                                                    dnnl::algorithm::convolution_direct, map,
                                                    weights, map, {1, 1}, {1, 1}, {1, 1});
  dnnl::convolution_forward::primitive_desc kernel(description, engine);
  while (std::string_view(kernel.impl_info_str()).substr(0, 3) == "brg")
    if (!kernel.next_impl()) break;
  const dnnl::memory::desc chosen = kernel.dst_desc();
  for (const Tag tag : {Tag::nChw16c, Tag::nChw8c}) {
    if (chosen == dnnl::memory::desc({1, 64, 24, 40}, type, tag)) return tag;
  }
  return Tag::nhwc;
}

Tag imageLayout(Tag layout) { return layout == Tag::nhwc ? Tag::nhwc : Tag::nchw; }

dnnl::memory::desc mapDescription(const MapShape& shape, Tag layout, dnnl::memory::data_type type) {
  return dnnl::memory::desc({1, shape.channels, shape.height, shape.width}, type, layout);
}

ChannelBlocks::ChannelBlocks(const MapShape& shape, Tag layout)
    : width(layout == Tag::nChw8c ? 8 : 16),
      block_stride(layout == Tag::nhwc ? width : width * shape.pixels()),
      pixel_stride(layout == Tag::nhwc ? shape.channels : width) {}

OneThread::OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }

OneThread::~OneThread() { omp_set_num_threads(before_); }

namespace {

constexpr double kEpsilon = 1e-5;

/// Kernels whose vectors fit into blocks of `width` channels.
const EncoderKernels& kernelsFor(std::int64_t width, InstructionSet instruction_set) {
  return encoderKernels(width == 8 ? std::min(instruction_set, InstructionSet::kAvx2)
                                   : instruction_set);
}

}  // namespace

EncoderNorm::EncoderNorm(const MapShape& shape, dnnl::memory::format_tag layout, const Tensor& gain,
                         const Tensor& shift, InstructionSet instruction_set)
    : pixels_(shape.pixels()),
      channels_(shape.channels),
      blocks_(shape, layout),
      kernels_(&kernelsFor(blocks_.width, instruction_set)),
      gain_(gain.values),
      shift_(shift.values) {}

float EncoderNorm::run(float* map, const float* residual, Activation activation,
                       double unit) const {
  const float floor =
      activation == Activation::kRelu ? 0.0F : -std::numeric_limits<float>::infinity();
  float largest = floor;
  float scale[kGroup];
  float offset[kGroup];
  for (std::int64_t group = 0; group < channels_ / kGroup; ++group) {
    scaleGroup(map, group, unit, scale, offset);
    for (std::int64_t lane = 0; lane < kGroup; lane += blocks_.width) {
      const std::int64_t block = (group * kGroup + lane) / blocks_.width;
      const float* other = residual == nullptr ? nullptr : residual + block * blocks_.block_stride;
      const NormLine line{scale + lane, offset + lane, other, floor};
      largest = std::max(largest, kernels_->apply(runOf(map, block), line));
    }
  }
  return largest;
}

ChannelRun EncoderNorm::runOf(float* map, std::int64_t block) const {
  return {map + block * blocks_.block_stride, blocks_.width, pixels_, blocks_.pixel_stride};
}

double EncoderNorm::sum(float* map, std::int64_t group, float mean, bool squared) const {
  Lanes lanes;
  for (std::int64_t lane = 0; lane < kGroup; lane += blocks_.width) {
    kernels_->sums(runOf(map, (group * kGroup + lane) / blocks_.width), mean, squared,
                   lanes.data() + lane);
  }
  return std::accumulate(lanes.begin(), lanes.end(), 0.0);
}

void EncoderNorm::scaleGroup(float* map, std::int64_t group, double unit, float* scale,
                             float* offset) const {
  const double count = static_cast<double>(kGroup * pixels_);
  const double mean = sum(map, group, 0.0F, false) / count;
  const double variance = sum(map, group, static_cast<float>(mean), true) / count;
  // (unit x - unit mean) / sqrt(unit^2 variance + epsilon)
  const double inverse = 1.0 / std::sqrt(variance + kEpsilon / (unit * unit));
  for (std::int64_t lane = 0; lane < kGroup; ++lane) {
    const std::size_t channel = static_cast<std::size_t>(group * kGroup + lane);
    scale[lane] = static_cast<float>(gain_[channel] * inverse);
    offset[lane] = static_cast<float>(shift_[channel] - mean * inverse * gain_[channel]);
  }
}

ConvolutionInput::ConvolutionInput(Precision precision, std::int64_t largest_size,
                                   InstructionSet instruction_set)
    : precision_(precision), kernels_(&encoderKernels(instruction_set)) {
  const auto size = static_cast<std::size_t>(largest_size);
  if (precision == Precision::kBf16) halves_.resize(size);
  if (precision == Precision::kInt8) bytes_.resize(size);
}

void* ConvolutionInput::data(float* map) {
  if (precision_ == Precision::kFp32) return map;
  return precision_ == Precision::kBf16 ? static_cast<void*>(halves_.data()) : bytes_.data();
}

void ConvolutionInput::update(const float* map, std::int64_t size, float largest) {
  if (precision_ == Precision::kBf16) kernels_->toBfloat16(map, size, halves_.data());
  if (precision_ != Precision::kInt8) return;
  constexpr float kMost = 255.0F;
  unit_ = largest > 0.0F ? static_cast<double>(largest / kMost) : 1.0;
  kernels_->toBytes(map, size, static_cast<float>(1.0 / unit_), bytes_.data());
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

/// Largest weight of each output channel / 127.
std::vector<float> weightUnits(const Tensor& weight) {
  std::vector<float> units;
  const std::size_t row = weight.values.size() / static_cast<std::size_t>(weight.shape[0]);
  for (auto begin = weight.values.begin(); begin != weight.values.end();
       begin += static_cast<long>(row)) {
    float largest = 0.0F;
    for (std::size_t i = 0; i < row; ++i) largest = std::max(largest, std::abs(begin[i]));
    units.push_back(largest > 0.0F ? largest / 127.0F : 1.0F);
  }
  return units;
}

std::vector<std::int8_t> weightBytes(const Tensor& weight, const std::vector<float>& units) {
  std::vector<std::int8_t> bytes;
  bytes.reserve(weight.values.size());
  const std::size_t row = weight.values.size() / units.size();
  for (std::size_t i = 0; i < weight.values.size(); ++i)
    bytes.push_back(static_cast<std::int8_t>(std::lround(weight.values[i] / units[i / row])));
  return bytes;
}

dnnl::memory::data_type inputType(Precision precision) {
  if (precision == Precision::kFp32) return dnnl::memory::data_type::f32;
  return precision == Precision::kBf16 ? dnnl::memory::data_type::bf16
                                       : dnnl::memory::data_type::u8;
}

dnnl::memory::data_type weightType(Precision precision) {
  return precision == Precision::kInt8 ? dnnl::memory::data_type::s8 : inputType(precision);
}

/// Scratch memory of its own, so that encoders in different threads share nothing; full float32
/// whatever the environment asks for; bytes times the units of their weights.
dnnl::primitive_attr attributes(bool relu, const Tensor& weight, Precision precision) {
  dnnl::primitive_attr attributes;
  attributes.set_fpmath_mode(dnnl::fpmath_mode::strict);
  attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);
  constexpr int kPerOutputChannel = 1 << 1;
  if (precision == Precision::kInt8)
    attributes.set_output_scales(kPerOutputChannel, weightUnits(weight));
  if (!relu) return attributes;
  dnnl::post_ops operations;
  operations.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
  attributes.set_post_ops(operations);
  return attributes;
}

/// A convolution as oneDNN is asked for it.
struct Asked {
  dnnl::memory::desc source;
  dnnl::memory::desc destination;
  ConvolutionOptions options;
};

dnnl::convolution_forward::primitive_desc describe(const dnnl::engine& engine, const Asked& asked,
                                                   const Tensor& weight, bool bias) {
  const dnnl::memory::dims strides = {asked.options.stride, asked.options.stride};
  const dnnl::memory::dims padding = {asked.options.padding, asked.options.padding};
  const dnnl::memory::desc weights(weight.shape, weightType(asked.options.precision), Tag::any);
  const auto kind = dnnl::prop_kind::forward_inference;
  const auto direct = dnnl::algorithm::convolution_direct;
  if (!bias) {
    return {{kind, direct, asked.source, weights, asked.destination, strides, padding, padding},
            attributes(false, weight, asked.options.precision),
            engine};
  }
  const dnnl::memory::desc biases({weight.shape[0]}, kFloat, Tag::a);
  return {
      {kind, direct, asked.source, weights, biases, asked.destination, strides, padding, padding},
      attributes(true, weight, asked.options.precision),
      engine};
}

}  // namespace

EncoderConvolution::EncoderConvolution(const dnnl::engine& engine, const MapShape& input,
                                       Tag layout, const ConvolutionOptions& options,
                                       const Tensor& weight, const Tensor* bias)
    : output_(inference::outputShape(input, weight.shape[0], weight.shape[2], options)),
      description_(
          describe(engine,
                   {mapDescription(input, input.channels < 8 ? imageLayout(layout) : layout,
                                   inputType(options.precision)),
                    mapDescription(output_, layout), options},
                   weight, bias != nullptr)),
      primitive_(description_) {
  loadWeights(engine, weight, bias, options.precision);
}

void EncoderConvolution::loadWeights(const dnnl::engine& engine, const Tensor& weight,
                                     const Tensor* bias, Precision precision) {
  dnnl::stream stream(engine);
  std::vector<std::int8_t> bytes;
  if (precision == Precision::kInt8) bytes = weightBytes(weight, weightUnits(weight));
  void* values =
      bytes.empty() ? static_cast<void*>(const_cast<float*>(weight.values.data())) : bytes.data();
  const auto type = bytes.empty() ? kFloat : dnnl::memory::data_type::s8;
  const dnnl::memory plain({weight.shape, type, Tag::oihw}, engine, values);
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
