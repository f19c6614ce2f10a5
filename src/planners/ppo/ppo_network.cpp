// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/ppo_network.h"

#include <algorithm>
#include <cmath>

#include "inference/transformer_layers.h"

namespace cdiff::planners {
namespace {

void addLayers(const std::string& network, std::int64_t outputs, inference::TensorList& list) {
  constexpr std::int64_t kHidden = PpoActor::kHidden;
  list.layer(network + ".first", {kHidden, static_cast<std::int64_t>(kPpoInputs)});
  list.layer(network + ".second", {kHidden, kHidden});
  list.layer(network + ".last", {outputs, kHidden});
}

PpoLayer actorLayer(const PpoActor::Weights& weights, const std::string& name) {
  return {weights.at("actor." + name + ".weight"), weights.at("actor." + name + ".bias")};
}

void rectify(std::array<float, PpoActor::kHidden>& values) {
  for (float& value : values) value = std::max(value, 0.0F);
}

}  // namespace

PpoLayer::PpoLayer(const inference::Tensor& weight, const inference::Tensor& bias)
    : inputs_(static_cast<std::size_t>(weight.shape.at(1))),
      weight_(weight.values.size()),
      bias_(bias.values) {
  const std::size_t outputs = bias_.size();
  for (std::size_t o = 0; o < outputs; ++o) {
    for (std::size_t i = 0; i < inputs_; ++i)
      weight_[i * outputs + o] = weight.values[o * inputs_ + i];
  }
}

void PpoLayer::apply(const float* x, float* y) const {
  const std::size_t outputs = bias_.size();
  std::copy(bias_.begin(), bias_.end(), y);
  for (std::size_t i = 0; i < inputs_; ++i) {
    const float value = x[i];
    if (value == 0.0F) continue;
    const float* row = weight_.data() + i * outputs;
    for (std::size_t o = 0; o < outputs; ++o) y[o] += row[o] * value;
  }
}

std::vector<inference::TensorShape> PpoActor::tensors() {
  inference::TensorList list;
  addLayers("actor", static_cast<std::int64_t>(kPpoActions), list);
  list.add("actor.log_deviation", {static_cast<std::int64_t>(kPpoActions)});
  addLayers("critic", 1, list);
  return list.take();
}

PpoActor::Weights PpoActor::readWeights(const std::filesystem::path& folder) {
  return planners::readWeights(kPpo, folder,
                               [](const WeightMetadata&, const std::string&) { return tensors(); });
}

PpoActor::PpoActor(const Weights& weights)
    : first_(actorLayer(weights, "first")),
      second_(actorLayer(weights, "second")),
      last_(actorLayer(weights, "last")) {
  const std::vector<float>& logarithm = weights.at("actor.log_deviation").values;
  for (std::size_t i = 0; i < kPpoActions; ++i) deviation_[i] = std::exp(logarithm.at(i));
}

PpoAction PpoActor::mean(const PpoObservation& observation) const {
  std::array<float, kHidden> first;
  std::array<float, kHidden> second;
  PpoAction mean;
  first_.apply(observation.data(), first.data());
  rectify(first);
  second_.apply(first.data(), second.data());
  rectify(second);
  last_.apply(second.data(), mean.data());
  return mean;
}

PpoAction PpoActor::act(const PpoObservation& observation) const {
  PpoAction action = mean(observation);
  for (float& value : action) value = std::tanh(value);
  return action;
}

}  // namespace cdiff::planners
