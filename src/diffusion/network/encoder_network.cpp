// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/network/encoder_network.h"

#include <algorithm>
#include <utility>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

constexpr std::int64_t kStemChannels = 64;
constexpr std::int64_t kSqueezedChannels = 64;
constexpr std::array<std::int64_t, 4> kStageBlocks = {3, 4, 6, 3};
constexpr std::array<std::int64_t, 4> kStageChannels = {64, 128, 256, 512};

std::string toText(const std::vector<std::int64_t>& shape) {
  std::string text;
  for (const std::int64_t side : shape) text += (text.empty() ? "" : ", ") + std::to_string(side);
  return "[" + text + "]";
}

const inference::Tensor& requireTensor(const Model& model, const std::string& name,
                                       const std::vector<std::int64_t>& shape) {
  const auto found = model.encoder.find(name);
  if (found == model.encoder.end())
    throw core::InputError("image encoder: model '" + model.name + "' lacks tensor '" + name + "'");
  if (found->second.shape == shape) return found->second;
  throw core::InputError("image encoder: tensor '" + name + "' of model '" + model.name + "' is " +
                         toText(found->second.shape) + ", but must be " + toText(shape));
}

}  // namespace

EncoderNetwork::EncoderNetwork(const Model& model, inference::Precision precision,
                               inference::InstructionSet instruction_set)
    : engine_(dnnl::engine::kind::cpu, 0),
      stream_(engine_),
      precision_(precision),
      instruction_set_(instruction_set),
      layout_(inference::preferredLayout(engine_, precision)),
      image_{3, model.architecture.image_height, model.architecture.image_width},
      shape_(image_) {
  const inference::OneThread one_thread;
  for (std::size_t value = 0; value < pixel_values_.size(); ++value)
    pixel_values_[value] = static_cast<float>((static_cast<double>(value) / 255.0 - 0.5) / 0.25);
  makeStem(model);
  for (std::size_t stage = 0; stage < kStageBlocks.size(); ++stage) {
    for (std::int64_t block = 0; block < kStageBlocks[stage]; ++block) {
      makeBlock(model, "layer" + std::to_string(stage + 1) + "." + std::to_string(block),
                kStageChannels[stage], stage > 0 && block == 0 ? 2 : 1);
    }
  }
  makeProjection(model);
  bindLayers();
}

inference::EncoderConvolution EncoderNetwork::convolution(const Model& model,
                                                          const std::string& name,
                                                          std::int64_t channels,
                                                          std::int64_t kernel,
                                                          std::int64_t stride) {
  const inference::Tensor& weight =
      requireTensor(model, name + ".weight", {channels, shape_.channels, kernel, kernel});
  const bool reads_image = shape_.channels == image_.channels;
  const inference::Precision precision = reads_image ? inference::Precision::kFp32 : precision_;
  inference::EncoderConvolution made(engine_, shape_, layout_, {stride, kernel / 2, precision},
                                     weight);
  shape_ = made.outputShape();
  return made;
}

inference::EncoderNorm EncoderNetwork::norm(const Model& model, const std::string& name,
                                            const inference::MapShape& shape) const {
  return inference::EncoderNorm(
      shape, layout_, requireTensor(model, name + ".weight", {shape.channels}),
      requireTensor(model, name + ".bias", {shape.channels}), instruction_set_);
}

void EncoderNetwork::makeStem(const Model& model) {
  stem_ = convolution(model, "stem.conv", kStemChannels, 7, 2);
  stem_norm_ = norm(model, "stem.norm", shape_);
  pooling_.emplace(engine_, shape_, layout_);
  shape_ = pooling_->outputShape();
}

void EncoderNetwork::makeBlock(const Model& model, const std::string& name, std::int64_t channels,
                               std::int64_t stride) {
  std::optional<inference::EncoderConvolution> down;
  std::optional<inference::EncoderNorm> down_norm;
  if (stride != 1 || shape_.channels != channels) {
    const inference::MapShape input = shape_;
    down = convolution(model, name + ".down.conv", channels, 1, stride);
    down_norm = norm(model, name + ".down.norm", shape_);
    shape_ = input;
  }
  inference::EncoderConvolution conv1 = convolution(model, name + ".conv1", channels, 3, stride);
  inference::EncoderNorm norm1 = norm(model, name + ".norm1", shape_);
  inference::EncoderConvolution conv2 = convolution(model, name + ".conv2", channels, 3, 1);
  inference::EncoderNorm norm2 = norm(model, name + ".norm2", shape_);
  blocks_.push_back({std::move(conv1),
                     std::move(norm1),
                     std::move(conv2),
                     std::move(norm2),
                     std::move(down),
                     std::move(down_norm),
                     {},
                     {},
                     nullptr,
                     {}});
}

void EncoderNetwork::makeProjection(const Model& model) {
  const inference::Tensor& bias = requireTensor(model, "squeeze.bias", {kSqueezedChannels});
  squeeze_.emplace(
      engine_, shape_, layout_, inference::ConvolutionOptions{},
      requireTensor(model, "squeeze.weight", {kSqueezedChannels, shape_.channels, 1, 1}), &bias);
  shape_ = squeeze_->outputShape();
  const std::int64_t features = model.architecture.image_features;
  const inference::Tensor& weight =
      requireTensor(model, "project.weight", {features, shape_.size()});
  projection_.resize(weight.values.size());
  for (std::int64_t feature = 0; feature < features; ++feature) {
    for (std::int64_t i = 0; i < shape_.size(); ++i) {
      projection_[static_cast<std::size_t>(i * features + feature)] =
          weight.values[static_cast<std::size_t>(feature * shape_.size() + i)];
    }
  }
  bias_ = requireTensor(model, "project.bias", {features}).values;
}

float* EncoderNetwork::newBuffer(std::int64_t floats) {
  buffers_.emplace_back(
      dnnl::memory::desc({floats}, dnnl::memory::data_type::f32, dnnl::memory::format_tag::a),
      engine_);
  return static_cast<float*>(buffers_.back().get_data_handle());
}

EncoderNetwork::Map EncoderNetwork::newMap(std::int64_t size) {
  inputs_.push_back(
      std::make_unique<inference::ConvolutionInput>(precision_, size, instruction_set_));
  return {newBuffer(size), inputs_.back().get()};
}

std::int64_t EncoderNetwork::scratchpadFloats() const {
  std::size_t bytes = std::max(stem_->scratchpadBytes(), squeeze_->scratchpadBytes());
  for (const Block& block : blocks_) {
    bytes = std::max({bytes, block.conv1.scratchpadBytes(), block.conv2.scratchpadBytes(),
                      block.down ? block.down->scratchpadBytes() : 0});
  }
  return static_cast<std::int64_t>(bytes / sizeof(float)) + 1;
}

void EncoderNetwork::bindLayers() {
  // The first map after pooling is the largest of all blocks, since each stage halves both sides
  // and doubles the channels.
  const std::int64_t largest = pooling_->outputShape().size();
  float* scratchpad = newBuffer(scratchpadFloats());
  pixels_ = newBuffer(image_.size());
  stem_map_ = newBuffer(stem_->outputShape().size());
  squeezed_ = newBuffer(shape_.size());
  Map input = newMap(largest);
  Map output = newMap(largest);
  const Map middle = newMap(largest);
  float* shortcut = newBuffer(largest);
  stem_->bind(engine_, pixels_, stem_map_, scratchpad);
  pooling_->bind(engine_, stem_map_, input.values);
  pooled_ = input;
  for (Block& block : blocks_) {
    block.input = input;
    block.middle = middle;
    block.shortcut = block.down ? shortcut : input.values;
    block.output = output;
    bindBlock(block, scratchpad);
    std::swap(input, output);
  }
  squeeze_->bind(engine_, input.values, squeezed_, scratchpad);
}

void EncoderNetwork::bindBlock(Block& block, float* scratchpad) {
  void* read = block.input.input->data(block.input.values);
  block.conv1.bind(engine_, read, block.middle.values, scratchpad);
  block.conv2.bind(engine_, block.middle.input->data(block.middle.values), block.output.values,
                   scratchpad);
  if (block.down) block.down->bind(engine_, read, block.shortcut, scratchpad);
}

void EncoderNetwork::readImage(const std::uint8_t* rgb) {
  const bool channels_last = inference::imageLayout(layout_) == dnnl::memory::format_tag::nhwc;
  const std::int64_t channel_stride = channels_last ? 1 : image_.pixels();
  const std::int64_t pixel_stride = channels_last ? image_.channels : 1;
  for (std::int64_t pixel = 0; pixel < image_.pixels(); ++pixel) {
    for (std::int64_t channel = 0; channel < image_.channels; ++channel)
      pixels_[pixel * pixel_stride + channel * channel_stride] = pixel_values_[*rgb++];
  }
}

std::vector<float> EncoderNetwork::encode(const std::uint8_t* rgb) {
  const inference::OneThread one_thread;
  readImage(rgb);
  stem_->run(stream_);
  // The largest value of the map is that of the pooled one: the windows cover all of it.
  const float largest =
      stem_norm_->run(stem_map_, nullptr, inference::EncoderNorm::Activation::kRelu);
  pooling_->run(stream_);
  pooled_.input->update(pooled_.values, pooling_->outputShape().size(), largest);
  for (const Block& block : blocks_) runBlock(block);
  squeeze_->run(stream_);
  stream_.wait();
  return project();
}

void EncoderNetwork::runBlock(const Block& block) {
  using Activation = inference::EncoderNorm::Activation;
  const std::int64_t size = block.conv2.outputShape().size();
  const double unit = block.input.input->unit();
  block.conv1.run(stream_);
  float largest = block.norm1.run(block.middle.values, nullptr, Activation::kRelu, unit);
  block.middle.input->update(block.middle.values, size, largest);
  block.conv2.run(stream_);
  if (block.down) {
    block.down->run(stream_);
    block.down_norm->run(block.shortcut, nullptr, Activation::kNone, unit);
  }
  largest = block.norm2.run(block.output.values, block.shortcut, Activation::kRelu,
                            block.middle.input->unit());
  block.output.input->update(block.output.values, size, largest);
}

std::vector<float> EncoderNetwork::project() const {
  std::vector<float> features = bias_;
  const inference::ChannelBlocks blocks(shape_, layout_);
  const float* weights = projection_.data();
  for (std::int64_t channel = 0; channel < shape_.channels; ++channel) {
    const float* lane =
        squeezed_ + channel / blocks.width * blocks.block_stride + channel % blocks.width;
    for (std::int64_t pixel = 0; pixel < shape_.pixels(); ++pixel) {
      const float value = lane[pixel * blocks.pixel_stride];
      for (float& feature : features) feature += value * *weights++;
    }
  }
  return features;
}

}  // namespace cdiff::diffusion
