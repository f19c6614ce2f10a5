// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/network/heads.h"

#include <algorithm>
#include <utility>

#include "e2e_cdiff/traffic/vehicle.h"
#include "inference/unet_layers.h"

namespace cdiff::diffusion {

/// Joins layers and variables as docs/network.md draws them.
class UNetBuilder {
 public:
  UNetBuilder(const inference::DenoiserKernels& kernels, const Architecture& architecture,
              const inference::Tensors& tensors)
      : source_{kernels, tensors, architecture.groups,
                std::max<std::int64_t>(architecture.kernel, 4) / 2},
        horizon_(architecture.horizon) {
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
  std::int64_t horizon_;
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
  inference::Slice input{parts_.noisy = addVariable(inputs, horizon_)};
  for (std::size_t l = 0; l < levels; ++l) {
    const std::string name = "down." + std::to_string(l);
    const std::int64_t rows = horizon_ >> l;
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
    const inference::Slice output{addVariable(layout, horizon_ >> l)};
    addBlockPair(name, {2 * channels[l], 2}, {{level_outputs[l].variable}, output});
    head_input_ = l > 1 ? level_outputs[l - 1].variable : addVariable(layout, horizon_);
    addSampling(name + ".sample", {output, {head_input_}}, true);
  }
}

void UNetBuilder::addHead(const inference::ChannelLayout& layout) {
  const inference::Variable* block = addVariable(layout, horizon_);
  parts_.actions = addVariable({traffic::kActionColumns}, horizon_);
  parts_.layers.push_back(std::make_unique<inference::HeadBlock>(
      source_, "head.block", layout, inference::Edge{{head_input_}, {block}}));
  parts_.layers.push_back(std::make_unique<inference::PlainConvolution>(
      source_, "head.out", inference::Spacing{}, inference::Edge{{block}, {parts_.actions}}));
}

UNet::UNet(const inference::DenoiserKernels& kernels, const Architecture& architecture,
           const inference::Tensors& tensors)
    : horizon_(architecture.horizon), parts_(UNetBuilder(kernels, architecture, tensors).take()) {}

void UNet::resize(std::int64_t samples) {
  samples_ = samples;
  for (const auto& variable : parts_.variables) variable->resize(samples);
  for (const auto& layer : parts_.layers) layer->resize(samples);
}

void UNet::forward(const float* noisy, const inference::Activation& injection, float* actions) {
  const std::int64_t columns = traffic::kRolloutColumns;
  for (std::int64_t b = 0; b < samples_; ++b) {
    inference::copyIn(noisy + b * horizon_ * columns, horizon_, columns,
                      parts_.noisy->value.view(b));
  }
  // Layer by layer: its weights stay in the cache for all samples.
  for (const auto& layer : parts_.layers) {
    for (std::int64_t b = 0; b < samples_; ++b) layer->forward(b, injection.row(b));
  }
  const std::int64_t results = traffic::kActionColumns;
  for (std::int64_t b = 0; b < samples_; ++b) {
    inference::copyOut(parts_.actions->value.view(b), horizon_, results,
                       actions + b * horizon_ * results);
  }
}

void UNet::backward(const float* action_gradient, float* noisy_gradient) {
  const std::int64_t columns = traffic::kActionColumns;
  for (std::int64_t b = 0; b < samples_; ++b) {
    inference::copyIn(action_gradient + b * horizon_ * columns, horizon_, columns,
                      parts_.actions->gradient.view(b));
  }
  for (auto layer = parts_.layers.rbegin(); layer != parts_.layers.rend(); ++layer) {
    for (std::int64_t b = 0; b < samples_; ++b) (*layer)->backward(b);
  }
  const std::int64_t results = traffic::kRolloutColumns;
  for (std::int64_t b = 0; b < samples_; ++b) {
    inference::copyOut(parts_.noisy->gradient.view(b), horizon_, results,
                       noisy_gradient + b * horizon_ * results);
  }
}

namespace {

/// gradient *= slope.
void multiply(const inference::Activation& gradient, const inference::Activation& slope) {
  float* values = gradient.view().data;
  const float* factors = slope.view().data;
  const std::int64_t count = gradient.rows() * gradient.channels();
  for (std::int64_t i = 0; i < count; ++i) values[i] *= factors[i];
}

inference::Filter columns(const inference::Tensors& tensors, std::int64_t first,
                          std::int64_t count) {
  return inference::Filter::ofLinear(inference::tensorNamed(tensors, "state.0.weight"), first,
                                     count);
}

}  // namespace

StateHead::Hidden::Hidden(std::int64_t width, std::int64_t rows)
    : input(inference::matrix(width, rows)),
      value(inference::matrix(width, rows)),
      slope(inference::matrix(width, rows)),
      gradient(inference::matrix(width, rows)) {}

StateHead::StateHead(const inference::DenoiserKernels& kernels, const Architecture& architecture,
                     const inference::Tensors& tensors,
                     const inference::Activation& time_embeddings)
    : kernels_(&kernels),
      action_values_(architecture.horizon * traffic::kActionColumns),
      state_values_(architecture.horizon * traffic::kStateColumns),
      width_(architecture.state_hidden),
      actions_(kernels, columns(tensors, 0, action_values_), inference::Spacing{}),
      actions_reversed_(inference::reversedLinear(kernels, columns(tensors, 0, action_values_))),
      middle_(inference::linearNamed(kernels, tensors, "state.2")),
      middle_reversed_(inference::reversedLinear(
          kernels, inference::Filter::ofLinear(inference::tensorNamed(tensors, "state.2.weight")))),
      out_(inference::linearNamed(kernels, tensors, "state.4")),
      out_reversed_(inference::reversedLinear(
          kernels, inference::Filter::ofLinear(inference::tensorNamed(tensors, "state.4.weight")))),
      time_part_(inference::matrix(width_, time_embeddings.rows())) {
  const std::int64_t speed = architecture.takesSpeed() ? 1 : 0;
  if (speed > 0)
    speed_.emplace(kernels, columns(tensors, action_values_, speed), inference::Spacing{});
  inference::Convolution(kernels, columns(tensors, action_values_ + speed, architecture.time_width),
                         inference::Spacing{}, &inference::tensorNamed(tensors, "state.0.bias"))
      .applyToRows(time_embeddings, time_part_);
}

void StateHead::setContexts(const std::vector<Context>& contexts) {
  const auto rows = static_cast<std::int64_t>(contexts.size());
  inference::Activation speeds = inference::matrix(1, rows);
  for (std::int64_t b = 0; b < rows; ++b) {
    *speeds.row(b) = static_cast<float>(contexts[static_cast<std::size_t>(b)].speed / kSpeedScale);
  }
  speed_part_ = inference::matrix(width_, rows);
  if (speed_) speed_->applyToRows(speeds, speed_part_);
  action_rows_ = inference::matrix(action_values_, rows);
  state_rows_ = inference::matrix(state_values_, rows);
  for (Hidden& hidden : hidden_) hidden = Hidden(width_, rows);
}

void StateHead::mish(Hidden& hidden) const {
  kernels_->mish(hidden.input.view().data, hidden.input.rows() * hidden.input.channels(),
                 hidden.value.view().data, hidden.slope.view().data);
}

void StateHead::forward(const float* actions, int k, float* states) {
  const std::int64_t rows = action_rows_.rows();
  const float* time = time_part_.row(k);
  for (std::int64_t b = 0; b < rows; ++b) {
    const float* speed = speed_part_.row(b);
    float* to = hidden_[0].input.row(b);
    for (std::int64_t c = 0; c < width_; ++c) to[c] = time[c] + speed[c];
  }
  inference::copyIn(actions, rows, action_values_, action_rows_.view());
  actions_.applyToRows(action_rows_, hidden_[0].input, true);
  mish(hidden_[0]);
  middle_.applyToRows(hidden_[0].value, hidden_[1].input);
  mish(hidden_[1]);
  out_.applyToRows(hidden_[1].value, state_rows_);
  inference::copyOut(state_rows_.view(), rows, state_values_, states);
}

void StateHead::backward(const float* state_gradient, float* action_gradient) {
  const std::int64_t rows = action_rows_.rows();
  inference::copyIn(state_gradient, rows, state_values_, state_rows_.view());
  out_reversed_.applyToRows(state_rows_, hidden_[1].gradient);
  multiply(hidden_[1].gradient, hidden_[1].slope);
  middle_reversed_.applyToRows(hidden_[1].gradient, hidden_[0].gradient);
  multiply(hidden_[0].gradient, hidden_[0].slope);
  actions_reversed_.applyToRows(hidden_[0].gradient, action_rows_);
  inference::copyOut(action_rows_.view(), rows, action_values_, action_gradient);
}

}  // namespace cdiff::diffusion
