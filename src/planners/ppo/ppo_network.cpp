// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/ppo_network.h"

#include <algorithm>
#include <cmath>

#include "inference/transformer_layers.h"

namespace cdiff::planners {

PpoLayer::PpoLayer(const inference::Tensor& weight, const inference::Tensor& bias)
    : weight_(weight.values.size()), bias_(bias.values) {
  const std::size_t outputs = bias_.size();
  const std::size_t inputs = weight_.size() / outputs;
  for (std::size_t o = 0; o < outputs; ++o) {
    for (std::size_t i = 0; i < inputs; ++i)
      weight_[i * outputs + o] = weight.values[o * inputs + i];
  }
}

std::vector<float> PpoLayer::apply(const std::vector<float>& x) const {
  std::vector<float> y = bias_;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float value = x[i];
    if (value == 0.0F) continue;
    const float* row = weight_.data() + i * y.size();
    for (std::size_t o = 0; o < y.size(); ++o) y[o] += row[o] * value;
  }
  return y;
}

std::vector<PpoLayerShape> ppoLayers(std::int64_t outputs) {
  constexpr std::int64_t kHidden = 256;
  return {{"first", {kHidden, static_cast<std::int64_t>(kPpoInputs)}},
          {"second", {kHidden, kHidden}},
          {"last", {outputs, kHidden}}};
}

std::vector<inference::TensorShape> PpoActor::tensors() {
  constexpr auto kOutputs = static_cast<std::int64_t>(kPpoActions);
  inference::TensorList list;
  for (const auto& [name, shape] : ppoLayers(kOutputs))
    list.layer("actor." + std::string(name), shape);
  list.add("actor.log_deviation", {kOutputs});
  for (const auto& [name, shape] : ppoLayers(1)) list.layer("critic." + std::string(name), shape);
  return list.take();
}

PpoActor::Weights PpoActor::readWeights(const std::filesystem::path& folder) {
  return planners::readWeights(kPpo, folder,
                               [](const WeightMetadata&, const std::string&) { return tensors(); });
}

PpoActor::PpoActor(const Weights& weights) {
  for (const PpoLayerShape& layer : ppoLayers(static_cast<std::int64_t>(kPpoActions))) {
    const std::string name = "actor." + std::string(layer.name);
    layers_.emplace_back(weights.at(name + ".weight"), weights.at(name + ".bias"));
  }
  const std::vector<float>& logarithm = weights.at("actor.log_deviation").values;
  for (std::size_t i = 0; i < kPpoActions; ++i) deviation_[i] = std::exp(logarithm.at(i));
}

PpoAction PpoActor::mean(const PpoObservation& observation) const {
  std::vector<float> x(observation.begin(), observation.end());
  for (const PpoLayer& layer : layers_) {
    x = layer.apply(x);
    if (&layer == &layers_.back()) break;
    for (float& value : x) value = std::max(value, 0.0F);
  }
  PpoAction mean;
  std::copy(x.begin(), x.end(), mean.begin());
  return mean;
}

PpoAction PpoActor::act(const PpoObservation& observation) const {
  PpoAction action = mean(observation);
  for (float& value : action) value = std::tanh(value);
  return action;
}

}  // namespace cdiff::planners
