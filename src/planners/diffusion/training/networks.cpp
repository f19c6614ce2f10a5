// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/networks.h"

#include <array>
#include <cmath>

#include "e2e_cdiff/traffic/vehicle.h"
#include "learning/layers.h"

namespace cdiff::planners {
namespace {

using learning::linear;
using learning::Start;
using learning::toTensor;

constexpr std::int64_t kSqueezed = 64;
constexpr std::int64_t kChannelsPerGroup = 16;
constexpr double kNormEpsilon = 1e-5;
constexpr std::int64_t kHeadHidden = 256;

/// Channels and number of the blocks of layer1 ... layer4.
constexpr std::array<std::int64_t, 4> kLayerChannels = {64, 128, 256, 512};
constexpr std::array<int, 4> kLayerBlocks = {3, 4, 6, 3};

std::int64_t mapSize(std::int64_t pixels) { return (pixels + 31) / 32; }

std::string blockName(std::size_t layer, int block) {
  return "layer" + std::to_string(layer + 1) + "." + std::to_string(block);
}

std::string level(const char* path, std::size_t index) {
  return std::string(path) + "." + std::to_string(index);
}

at::Tensor sinusoids(std::int64_t steps, std::int64_t width) {
  const std::int64_t half = width / 2;
  std::vector<float> values;
  for (std::int64_t k = 0; k <= steps; ++k) {
    for (std::int64_t i = 0; i < width; ++i) {
      const double frequency = std::exp(-std::log(10000.0) * static_cast<double>(i % half) /
                                        static_cast<double>(half - 1));
      const double angle = static_cast<double>(k) * frequency;
      values.push_back(static_cast<float>(i < half ? std::sin(angle) : std::cos(angle)));
    }
  }
  return toTensor(values, {steps + 1, width}, at::kCPU);
}

/// x tanh(ln(1 + e^x)) = x n / (n + 2) with n = e^x (e^x + 2): several times as fast as at::mish.
at::Tensor fastMish(const at::Tensor& x) {
  const at::Tensor power = at::exp(at::clamp_max(x, 20.0));
  const at::Tensor n = power * (power + 2.0);
  return x * (n / (n + 2.0));
}

}  // namespace

ImageEncoderNet::ImageEncoderNet(const diffusion::Architecture& architecture, std::uint64_t seed)
    : architecture_(architecture), parameters_(core::RandomStream(seed, "encoder start")) {
  parameters_.declareConvolution("stem.conv", {kLayerChannels[0], 3, 7, 7});
  parameters_.declareNorm("stem.norm", kLayerChannels[0]);
  std::int64_t inputs = kLayerChannels[0];
  for (std::size_t layer = 0; layer < kLayerChannels.size(); ++layer) {
    for (int b = 0; b < kLayerBlocks[layer]; ++b) {
      declareBlock(blockName(layer, b), inputs, kLayerChannels[layer]);
      inputs = kLayerChannels[layer];
    }
  }
  parameters_.declareLayer("squeeze", {kSqueezed, inputs, 1, 1});
  parameters_.declareLayer(
      "project", {architecture.image_features, kSqueezed * mapSize(architecture.image_height) *
                                                   mapSize(architecture.image_width)});
}

void ImageEncoderNet::declareBlock(const std::string& name, std::int64_t inputs,
                                   std::int64_t outputs) {
  parameters_.declareConvolution(name + ".conv1", {outputs, inputs, 3, 3});
  parameters_.declareNorm(name + ".norm1", outputs);
  parameters_.declareConvolution(name + ".conv2", {outputs, outputs, 3, 3});
  parameters_.declareNorm(name + ".norm2", outputs, 0.0);  // a block starts as the identity
  if (inputs == outputs) return;
  parameters_.declareConvolution(name + ".down.conv", {outputs, inputs, 1, 1});
  parameters_.declareNorm(name + ".down.norm", outputs);
}

at::Tensor ImageEncoderNet::norm(const std::string& name, const at::Tensor& x) const {
  return at::group_norm(x, x.size(1) / kChannelsPerGroup, parameters_(name + ".weight"),
                        parameters_(name + ".bias"), kNormEpsilon);
}

at::Tensor ImageEncoderNet::convolve(const std::string& name, const at::Tensor& x,
                                     std::int64_t stride, std::int64_t padding) const {
  const at::Tensor& weight = parameters_(name + ".weight");
  if (!half_precision_) return at::conv2d(x, weight, {}, stride, padding);
  return at::conv2d(x.to(at::kBFloat16), weight.to(at::kBFloat16), {}, stride, padding)
      .to(at::kFloat);
}

at::Tensor ImageEncoderNet::block(const std::string& name, const at::Tensor& x,
                                  std::int64_t stride) const {
  at::Tensor h = convolve(name + ".conv1", x, stride, 1);
  h = at::relu(norm(name + ".norm1", h));
  h = norm(name + ".norm2", convolve(name + ".conv2", h, 1, 1));
  if (!parameters_.has(name + ".down.conv.weight")) return at::relu(h + x);
  return at::relu(h + norm(name + ".down.norm", convolve(name + ".down.conv", x, stride, 0)));
}

at::Tensor ImageEncoderNet::forward(const at::Tensor& images) const {
  at::Tensor x = convolve("stem.conv", images, 2, 3);
  x = at::max_pool2d(at::relu(norm("stem.norm", x)), 3, 2, 1);
  for (std::size_t layer = 0; layer < kLayerChannels.size(); ++layer) {
    for (int b = 0; b < kLayerBlocks[layer]; ++b)
      x = block(blockName(layer, b), x, layer > 0 && b == 0 ? 2 : 1);
  }
  const std::array<std::int64_t, 2> full = {mapSize(architecture_.image_height),
                                            mapSize(architecture_.image_width)};
  if (x.size(2) != full[0] || x.size(3) != full[1])
    x = at::upsample_bilinear2d(x, full, /*align_corners=*/false);
  x = at::relu(at::conv2d(x, parameters_("squeeze.weight"), parameters_("squeeze.bias")));
  return linear(parameters_, "project", x.flatten(1));
}

DenoiserNet::DenoiserNet(const diffusion::Architecture& architecture, std::uint64_t seed)
    : architecture_(architecture),
      parameters_(core::RandomStream(seed, "denoiser start")),
      sinusoids_(sinusoids(architecture.diffusion_steps, architecture.time_width)) {
  declareContext();
  declareLevels();
  const std::int64_t outputs = architecture.channels.front();
  parameters_.declareLayer("head.block.conv", {outputs, outputs, architecture.kernel});
  parameters_.declareNorm("head.block.norm", outputs);
  parameters_.declareLayer("head.out", {traffic::kActionColumns, outputs, 1});
  const std::int64_t state_inputs = traffic::kActionColumns * architecture.horizon +
                                    (architecture.startsFromSpeed() ? 1 : 0) +
                                    architecture.time_width;
  parameters_.declareLayer("state.0", {architecture.state_hidden, state_inputs});
  parameters_.declareLayer("state.2", {architecture.state_hidden, architecture.state_hidden});
  parameters_.declareLayer(
      "state.4", {traffic::kStateColumns * architecture.horizon, architecture.state_hidden});
}

void DenoiserNet::declareContext() {
  const diffusion::Architecture& a = architecture_;
  if (a.takesRoute()) {
    parameters_.declareLayer("route.0", {2 * a.route_features, 2 * a.route_points});
    parameters_.declareLayer("route.2", {a.route_features, 2 * a.route_features});
    parameters_.declare("no_route", {a.route_features}, {Start::Kind::kUniform, 0.1});
  }
  if (a.takesSpeed()) parameters_.declareLayer("speed.0", {a.speed_features, 1});
  if (a.takesPrevious())
    parameters_.declare("no_previous", {a.image_features}, {Start::Kind::kUniform, 0.1});
  if (a.takesTarget()) {
    parameters_.declareLayer("target.0", {a.target_features, 1});
    parameters_.declare("no_target", {a.target_features}, {Start::Kind::kUniform, 0.1});
  }
  if (a.context_width > 0)
    parameters_.declareLayer("context.0", {a.context_width, a.joinedFeatures()});
  parameters_.declareLayer("time.0", {4 * a.time_width, a.time_width});
  parameters_.declareLayer("time.2", {a.time_width, 4 * a.time_width});
}

void DenoiserNet::declareBlock(const std::string& name, std::int64_t inputs, std::int64_t outputs) {
  const std::int64_t kernel = architecture_.kernel;
  parameters_.declareLayer(name + ".block1.conv", {outputs, inputs, kernel});
  parameters_.declareNorm(name + ".block1.norm", outputs);
  parameters_.declareLayer(name + ".inject",
                           {outputs, architecture_.time_width + architecture_.contextValues()});
  parameters_.declareLayer(name + ".block2.conv", {outputs, outputs, kernel});
  parameters_.declareNorm(name + ".block2.norm", outputs);
  if (inputs != outputs) parameters_.declareLayer(name + ".skip", {outputs, inputs, 1});
}

void DenoiserNet::declareLevels() {
  const std::vector<std::int64_t>& channels = architecture_.channels;
  std::int64_t inputs = traffic::kRolloutColumns;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    declareBlock(level("down", i) + ".a", inputs, channels[i]);
    declareBlock(level("down", i) + ".b", channels[i], channels[i]);
    if (i + 1 < channels.size())
      parameters_.declareLayer(level("down", i) + ".sample", {channels[i], channels[i], 3});
    inputs = channels[i];
  }
  declareBlock("middle.a", inputs, inputs);
  declareBlock("middle.b", inputs, inputs);
  for (std::size_t i = 0; i + 1 < channels.size(); ++i) {
    const std::int64_t outputs = channels[channels.size() - 2 - i];
    declareBlock(level("up", i) + ".a", 2 * channels[channels.size() - 1 - i], outputs);
    declareBlock(level("up", i) + ".b", outputs, outputs);
    parameters_.declareLayer(level("up", i) + ".sample", {outputs, outputs, 4}, true);
  }
}

void DenoiserNet::moveTo(const at::Device& device) {
  parameters_.moveTo(device);
  sinusoids_ = sinusoids_.to(device);
}

at::Tensor DenoiserNet::contextOf(const ContextBatch& context) const {
  std::vector<at::Tensor> joined = {context.features};
  if (architecture_.takesRoute()) {
    const at::Tensor hidden = fastMish(linear(parameters_, "route.0", context.route));
    joined.push_back(context.has_route * linear(parameters_, "route.2", hidden) +
                     (1 - context.has_route) * parameters_("no_route"));
  }
  if (architecture_.takesSpeed())
    joined.push_back(fastMish(linear(parameters_, "speed.0", context.speed)));
  if (architecture_.takesPrevious())
    joined.push_back(context.has_previous * context.previous +
                     (1 - context.has_previous) * parameters_("no_previous"));
  if (architecture_.takesTarget()) {
    joined.push_back(context.has_target *
                         fastMish(linear(parameters_, "target.0", context.target)) +
                     (1 - context.has_target) * parameters_("no_target"));
  }
  if (architecture_.context_width == 0) return at::cat(joined, 1);
  return fastMish(linear(parameters_, "context.0", at::cat(joined, 1)));
}

at::Tensor DenoiserNet::timeEmbedding(const at::Tensor& k) const {
  const at::Tensor hidden = linear(parameters_, "time.0", sinusoids_.index_select(0, k));
  return linear(parameters_, "time.2", fastMish(hidden));
}

at::Tensor DenoiserNet::convolve(const std::string& name, const at::Tensor& x,
                                 std::int64_t stride) const {
  const at::Tensor& weight = parameters_(name + ".weight");
  return at::conv1d(x, weight, parameters_(name + ".bias"), stride, weight.size(2) / 2);
}

at::Tensor DenoiserNet::doubled(const std::string& name, const at::Tensor& x) const {
  const at::Tensor taps = parameters_(name + ".weight").transpose(0, 1);  // [out, in, 4]
  const auto tap = [&](std::int64_t index) { return taps.narrow(2, index, 1); };
  const at::Tensor none = at::zeros_like(tap(0));
  const at::Tensor weight =
      at::cat({at::cat({tap(3), tap(1), none}, 2), at::cat({none, tap(2), tap(0)}, 2)}, 0);
  const at::Tensor& bias = parameters_(name + ".bias");
  const at::Tensor y = at::conv1d(x, weight, at::cat({bias, bias}), 1, 1);
  return y.view({x.size(0), 2, taps.size(0), x.size(2)})
      .permute({0, 2, 3, 1})
      .reshape({x.size(0), taps.size(0), 2 * x.size(2)});
}

at::Tensor DenoiserNet::smooth(const std::string& name, const at::Tensor& x) const {
  return fastMish(at::group_norm(convolve(name + ".conv", x), architecture_.groups,
                                 parameters_(name + ".norm.weight"),
                                 parameters_(name + ".norm.bias"), kNormEpsilon));
}

at::Tensor DenoiserNet::block(const std::string& name, const at::Tensor& x,
                              const at::Tensor& z) const {
  at::Tensor h = smooth(name + ".block1", x);
  h = h + linear(parameters_, name + ".inject", z).unsqueeze(2);
  h = smooth(name + ".block2", h);
  return h + (parameters_.has(name + ".skip.weight") ? convolve(name + ".skip", x) : x);
}

at::Tensor DenoiserNet::behindCurrentState(const at::Tensor& noisy,
                                           const ContextBatch& context) const {
  if (!architecture_.pinsCurrentState()) return noisy;
  const std::int64_t rows = architecture_.current_state_rows;
  const at::Tensor state =
      at::zeros({noisy.size(0), rows, traffic::kRolloutColumns}, noisy.options());
  state.select(2, traffic::kRolloutSpeed).copy_(context.speed.expand({-1, rows}));
  return at::cat({state, noisy}, 1);
}

at::Tensor DenoiserNet::predictActions(const at::Tensor& noisy, const at::Tensor& k,
                                       const ContextBatch& context) const {
  const at::Tensor z = fastMish(at::cat({timeEmbedding(k), contextOf(context)}, 1));
  const std::size_t levels = architecture_.channels.size();
  at::Tensor x = behindCurrentState(noisy, context).transpose(1, 2);
  std::vector<at::Tensor> skips;
  for (std::size_t i = 0; i < levels; ++i) {
    x = block(level("down", i) + ".b", block(level("down", i) + ".a", x, z), z);
    skips.push_back(x);
    if (i + 1 < levels) x = convolve(level("down", i) + ".sample", x, 2);
  }
  x = block("middle.b", block("middle.a", x, z), z);
  for (std::size_t i = 0; i + 1 < levels; ++i) {
    x = at::cat({x, skips[levels - 1 - i]}, 1);
    x = block(level("up", i) + ".b", block(level("up", i) + ".a", x, z), z);
    x = doubled(level("up", i) + ".sample", x);
  }
  return convolve("head.out", smooth("head.block", x))
      .transpose(1, 2)
      .narrow(1, architecture_.current_state_rows, architecture_.horizon);
}

at::Tensor DenoiserNet::predictStates(const at::Tensor& actions, const at::Tensor& k,
                                      const ContextBatch& context, bool detach) const {
  const at::Tensor flat = (detach ? actions.detach() : actions).reshape({actions.size(0), -1});
  std::vector<at::Tensor> inputs = {flat};
  if (architecture_.startsFromSpeed()) inputs.push_back(context.speed);
  inputs.push_back(timeEmbedding(k));
  at::Tensor h = at::cat(inputs, 1);
  h = fastMish(linear(parameters_, "state.0", h));
  h = fastMish(linear(parameters_, "state.2", h));
  return linear(parameters_, "state.4", h)
      .reshape({actions.size(0), architecture_.horizon, traffic::kStateColumns});
}

RegressionHead::RegressionHead(const diffusion::Architecture& architecture, std::int64_t auxiliary,
                               std::uint64_t seed)
    : parameters_(core::RandomStream(seed, "regression start")) {
  parameters_.declareLayer("regression.0", {kHeadHidden, architecture.image_features + 1 +
                                                             2 * architecture.route_points + 1});
  parameters_.declareLayer(
      "regression.2", {traffic::kRolloutColumns * architecture.horizon + auxiliary, kHeadHidden});
}

at::Tensor RegressionHead::forward(const ContextBatch& context) const {
  const at::Tensor input = at::cat(
      {context.features, context.speed, context.route * context.has_route, context.has_route}, 1);
  return linear(parameters_, "regression.2", fastMish(linear(parameters_, "regression.0", input)));
}

}  // namespace cdiff::planners
