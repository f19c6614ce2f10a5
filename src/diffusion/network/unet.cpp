// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/network/unet.h"

#include <algorithm>
#include <array>
#include <utility>

#include "e2e_cdiff/traffic/vehicle.h"
#include "inference/unet_layers.h"

namespace cdiff::diffusion {

/// Joins layers and variables as docs/neural_network.md draws them.
class UNetBuilder {
 public:
  UNetBuilder(const inference::DenoiserKernels& kernels, const Architecture& architecture,
              const inference::Tensors& tensors)
      : source_{kernels, tensors, architecture.groups,
                std::max<std::int64_t>(architecture.kernel, 4) / 2},
        rows_(architecture.rows()) {
    addLevels(architecture);
    addHead({architecture.channels.front()});
  }
  UNet::Parts take() { return std::move(parts_); }

 private:
  const inference::Variable* addVariable(const inference::ChannelLayout& layout, std::int64_t rows);
  void addBlock(const std::string& name, const inference::ChannelLayout& inputs,
                const inference::Edge& edge);
  /// R(inputs -> channels) from `edge.input`, R(channels -> channels) to `edge.output`.
  void addBlockPair(const std::string& name, const inference::ChannelLayout& inputs,
                    const inference::Edge& edge);
  void addLevels(const Architecture& architecture);
  /// Sampling down after a level, or up.
  void addSampling(const std::string& name, const inference::Edge& edge, bool up);
  void addHead(const inference::ChannelLayout& layout);

  inference::LayerSource source_;
  std::int64_t rows_;
  const inference::Variable* head_input_ = nullptr;
  UNet::Parts parts_;
};

const inference::Variable* UNetBuilder::addVariable(const inference::ChannelLayout& layout,
                                                    std::int64_t rows) {
  parts_.variables.push_back(std::make_unique<inference::Variable>(layout, rows, source_.halo));
  return parts_.variables.back().get();
}

void UNetBuilder::addBlock(const std::string& name, const inference::ChannelLayout& inputs,
                           const inference::Edge& edge) {
  const inference::Tensor& bias = inference::tensorNamed(source_.tensors, name + ".inject.bias");
  const inference::ChannelLayout layout{bias.shape[0]};
  const std::int64_t first =
      parts_.injections.empty()
          ? 0
          : parts_.injections.back().first + parts_.injections.back().layout.padded();
  parts_.injections.push_back({name + ".inject", layout, first});
  parts_.layers.push_back(
      std::make_unique<inference::ResidualBlock>(source_, name, inputs, edge, first));
}

void UNetBuilder::addBlockPair(const std::string& name, const inference::ChannelLayout& inputs,
                               const inference::Edge& edge) {
  const inference::ChannelLayout layout{
      inference::tensorNamed(source_.tensors, name + ".a.inject.bias").shape[0]};
  const inference::Slice between{addVariable(layout, edge.output.variable->value.rows())};
  addBlock(name + ".a", inputs, {edge.input, between, edge.shared_input});
  addBlock(name + ".b", layout, {between, edge.output});
}

void UNetBuilder::addSampling(const std::string& name, const inference::Edge& edge, bool up) {
  parts_.layers.push_back(std::make_unique<inference::PlainConvolution>(
      source_, name, inference::Spacing{2, 1, up}, edge));
}

/// The output of level l > 0 lies in the right half of the input of the up level that joins it, so
/// that nothing is copied; the left half comes from below.
void UNetBuilder::addLevels(const Architecture& architecture) {
  const std::vector<std::int64_t>& channels = architecture.channels;
  const std::size_t levels = channels.size();
  std::vector<inference::Slice> level_outputs(levels);
  inference::ChannelLayout inputs{traffic::kRolloutColumns};
  inference::Slice input{parts_.noisy = addVariable(inputs, rows_)};
  for (std::size_t l = 0; l < levels; ++l) {
    const std::string name = "down." + std::to_string(l);
    const std::int64_t rows = rows_ >> l;
    const inference::ChannelLayout layout{channels[l]};
    const inference::ChannelLayout joined{2 * channels[l], 2};
    level_outputs[l] = l == 0 ? inference::Slice{addVariable(layout, rows)}
                              : inference::Slice{addVariable(joined, rows), layout.padded()};
    addBlockPair(name, inputs, {input, level_outputs[l]});
    inputs = layout;
    if (l + 1 == levels) break;
    input = inference::Slice{addVariable(layout, rows / 2)};
    addSampling(name + ".sample", {level_outputs[l], input, l > 0}, false);
  }
  addBlockPair("middle", inputs, {level_outputs.back(), {level_outputs.back().variable}, true});
  for (std::size_t l = levels - 1; l > 0; --l) {
    const std::string name = "up." + std::to_string(levels - 1 - l);
    const inference::ChannelLayout layout{channels[l - 1]};
    const inference::Slice output{addVariable(layout, rows_ >> l)};
    addBlockPair(name, {2 * channels[l], 2}, {{level_outputs[l].variable}, output});
    head_input_ = l > 1 ? level_outputs[l - 1].variable : addVariable(layout, rows_);
    addSampling(name + ".sample", {output, {head_input_}}, true);
  }
}

void UNetBuilder::addHead(const inference::ChannelLayout& layout) {
  const inference::Variable* block = addVariable(layout, rows_);
  parts_.actions = addVariable({traffic::kActionColumns}, rows_);
  parts_.layers.push_back(std::make_unique<inference::HeadBlock>(
      source_, "head.block", layout, inference::Edge{{head_input_}, {block}}));
  parts_.layers.push_back(std::make_unique<inference::PlainConvolution>(
      source_, "head.out", inference::Spacing{}, inference::Edge{{block}, {parts_.actions}}));
}

UNet::UNet(const inference::DenoiserKernels& kernels, const Architecture& architecture,
           const inference::Tensors& tensors)
    : horizon_(architecture.horizon),
      pinned_rows_(architecture.current_state_rows),
      parts_(UNetBuilder(kernels, architecture, tensors).take()) {}

void UNet::setContexts(const std::vector<Context>& contexts) {
  samples_ = static_cast<std::int64_t>(contexts.size());
  speeds_.clear();
  for (const Context& context : contexts)
    speeds_.push_back(static_cast<float>(context.speed / kSpeedScale));
  for (const auto& variable : parts_.variables) variable->resize(samples_);
  for (const auto& layer : parts_.layers) layer->resize(samples_);
}

void UNet::writeCurrentState(std::int64_t sample) {
  std::array<float, traffic::kRolloutColumns> state = {};
  state[traffic::kRolloutSpeed] = speeds_[static_cast<std::size_t>(sample)];
  for (std::int64_t row = 0; row < pinned_rows_; ++row)
    inference::copyIn(state.data(), 1, traffic::kRolloutColumns,
                      parts_.noisy->value.view(sample, 0, row));
}

void UNet::forward(const float* noisy, const inference::Activation& injection, float* actions) {
  const std::int64_t columns = traffic::kRolloutColumns;
  for (std::int64_t b = 0; b < samples_; ++b) {
    writeCurrentState(b);
    inference::copyIn(noisy + b * horizon_ * columns, horizon_, columns,
                      parts_.noisy->value.view(b, 0, pinned_rows_));
  }
  // Layer by layer: its weights stay in the cache for all samples.
  for (const auto& layer : parts_.layers) {
    for (std::int64_t b = 0; b < samples_; ++b) layer->forward(b, injection.row(b));
  }
  const std::int64_t results = traffic::kActionColumns;
  for (std::int64_t b = 0; b < samples_; ++b) {
    inference::copyOut(parts_.actions->value.view(b, 0, pinned_rows_), horizon_, results,
                       actions + b * horizon_ * results);
  }
}

void UNet::backward(const float* action_gradient, float* noisy_gradient) {
  const std::int64_t columns = traffic::kActionColumns;
  for (std::int64_t b = 0; b < samples_; ++b) {
    inference::copyIn(action_gradient + b * horizon_ * columns, horizon_, columns,
                      parts_.actions->gradient.view(b, 0, pinned_rows_));
  }
  for (auto layer = parts_.layers.rbegin(); layer != parts_.layers.rend(); ++layer) {
    for (std::int64_t b = 0; b < samples_; ++b) (*layer)->backward(b);
  }
  const std::int64_t results = traffic::kRolloutColumns;
  for (std::int64_t b = 0; b < samples_; ++b) {
    inference::copyOut(parts_.noisy->gradient.view(b, 0, pinned_rows_), horizon_, results,
                       noisy_gradient + b * horizon_ * results);
  }
}

}  // namespace cdiff::diffusion
