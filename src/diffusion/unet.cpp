// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "unet.h"

#include <algorithm>

#include "e2e_cdiff/traffic/rollout.h"

namespace cdiff::diffusion {

UNet::UNet(const DenoiserKernels& kernels, const Architecture& architecture, const Tensors& tensors)
    : source_{kernels, tensors, architecture.groups,
              std::max<std::int64_t>(architecture.kernel, 4) / 2},
      horizon_(architecture.horizon) {
  addLevels(architecture);
  addHead({architecture.channels.front()});
}

const Signal* UNet::addSignal(const ChannelLayout& layout, std::int64_t rows) {
  signals_.push_back(std::make_unique<Signal>(layout, rows, source_.halo));
  return signals_.back().get();
}

void UNet::addBlock(const std::string& name, const ChannelLayout& inputs,
                    const Connection& connection) {
  const Tensor& bias = tensorNamed(source_.tensors, name + ".inject.bias");
  const ChannelLayout layout{bias.shape[0]};
  const std::int64_t first =
      injections_.empty() ? 0 : injections_.back().first + injections_.back().layout.padded();
  injections_.push_back({name + ".inject", layout, first});
  layers_.push_back(std::make_unique<ResidualBlock>(source_, name, inputs, connection, first));
}

void UNet::addBlockPair(const std::string& name, const ChannelLayout& inputs,
                        const Connection& connection) {
  const ChannelLayout layout{tensorNamed(source_.tensors, name + ".a.inject.bias").shape[0]};
  const Port between{addSignal(layout, connection.output.signal->value.rows())};
  addBlock(name + ".a", inputs, {connection.input, between, connection.shared_input});
  addBlock(name + ".b", layout, {between, connection.output});
}

void UNet::addSampling(const std::string& name, const Connection& connection, bool up) {
  layers_.push_back(
      std::make_unique<PlainConvolution>(source_, name, Spacing{2, 1, up}, connection));
}

/// The output of level l > 0 lies in the right half of the input of the up level that joins it, so
/// that nothing is copied; the left half comes from below.
void UNet::addLevels(const Architecture& architecture) {
  const std::vector<std::int64_t>& channels = architecture.channels;
  const std::size_t levels = channels.size();
  std::vector<Port> level_outputs(levels);
  ChannelLayout inputs{traffic::kRolloutColumns};
  Port input{noisy_ = addSignal(inputs, horizon_)};
  for (std::size_t l = 0; l < levels; ++l) {
    const std::string name = "down." + std::to_string(l);
    const std::int64_t rows = horizon_ >> l;
    const ChannelLayout layout{channels[l]};
    const ChannelLayout joined{2 * channels[l], 2};
    level_outputs[l] =
        l == 0 ? Port{addSignal(layout, rows)} : Port{addSignal(joined, rows), layout.padded()};
    addBlockPair(name, inputs, {input, level_outputs[l]});
    inputs = layout;
    if (l + 1 == levels) break;
    input = Port{addSignal(layout, rows / 2)};
    addSampling(name + ".sample", {level_outputs[l], input, l > 0}, false);
  }
  addBlockPair("middle", inputs, {level_outputs.back(), {level_outputs.back().signal}, true});
  for (std::size_t l = levels - 1; l > 0; --l) {
    const std::string name = "up." + std::to_string(levels - 1 - l);
    const ChannelLayout layout{channels[l - 1]};
    const Port output{addSignal(layout, horizon_ >> l)};
    addBlockPair(name, {2 * channels[l], 2}, {{level_outputs[l].signal}, output});
    head_input_ = l > 1 ? level_outputs[l - 1].signal : addSignal(layout, horizon_);
    addSampling(name + ".sample", {output, {head_input_}}, true);
  }
}

void UNet::addHead(const ChannelLayout& layout) {
  const Signal* block = addSignal(layout, horizon_);
  actions_ = addSignal({traffic::kActionColumns}, horizon_);
  layers_.push_back(std::make_unique<HeadBlock>(source_, "head.block", layout,
                                                Connection{{head_input_}, {block}}));
  layers_.push_back(std::make_unique<PlainConvolution>(source_, "head.out", Spacing{},
                                                       Connection{{block}, {actions_}}));
}

void UNet::resize(std::int64_t samples) {
  samples_ = samples;
  for (const auto& signal : signals_) signal->resize(samples);
  for (const auto& layer : layers_) layer->resize(samples);
}

void UNet::forward(const float* noisy, const View& injection, float* actions) {
  copyIn(noisy, {traffic::kRolloutColumns, horizon_, samples_}, noisy_->value.view());
  for (const auto& layer : layers_) layer->forward({samples_, injection});
  copyOut(actions_->value.view(), {traffic::kActionColumns, horizon_, samples_}, actions);
}

void UNet::pullBack(const float* action_gradient, float* noisy_gradient) {
  copyIn(action_gradient, {traffic::kActionColumns, horizon_, samples_}, actions_->gradient.view());
  for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
    (*layer)->pullBack({samples_, {}});
  }
  copyOut(noisy_->gradient.view(), {traffic::kRolloutColumns, horizon_, samples_}, noisy_gradient);
}

}  // namespace cdiff::diffusion
