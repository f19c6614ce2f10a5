// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/ppo_network.h"

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::planners {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTraining = "train them with cdiff train --task ppo --suite FOLDER --output ";

void addLayers(const std::string& network, std::int64_t outputs,
               std::vector<inference::TensorShape>& tensors) {
  constexpr std::int64_t kHidden = PpoActor::kHidden;
  const std::int64_t sizes[] = {static_cast<std::int64_t>(kPpoInputs), kHidden, kHidden, outputs};
  const char* const names[] = {"first", "second", "last"};
  for (int i = 0; i < 3; ++i) {
    const std::string name = network + "." + names[i];
    tensors.push_back({name + ".weight", {sizes[i + 1], sizes[i]}});
    tensors.push_back({name + ".bias", {sizes[i + 1]}});
  }
}

PpoLayer actorLayer(const PpoActor::Weights& weights, const std::string& name) {
  return {weights.at("actor." + name + ".weight"), weights.at("actor." + name + ".bias")};
}

void rectify(std::array<float, PpoActor::kHidden>& values) {
  for (float& value : values) value = std::max(value, 0.0F);
}

[[noreturn]] void refuseFormat(const fs::path& file, const std::string& found) {
  throw core::InputError("weight file '" + file.string() + "': its format is " + found +
                         ", expected '" + PpoActor::kFormat +
                         "': these are weights of another planner or version; name a folder that "
                         "cdiff train --task ppo wrote");
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
  std::vector<inference::TensorShape> tensors;
  addLayers("actor", static_cast<std::int64_t>(kPpoActions), tensors);
  tensors.push_back({"actor.log_deviation", {static_cast<std::int64_t>(kPpoActions)}});
  addLayers("critic", 1, tensors);
  return tensors;
}

fs::path PpoActor::weightFile(const fs::path& folder) {
  const fs::path file = folder / kFile;
  if (core::isFile(file)) return file;
  throw core::InputError("planner 'ppo' has no weights: there is no file '" + file.string() +
                         "'; " + kTraining + folder.string() +
                         ", or name a folder that holds them (ppo.weights)");
}

PpoActor::Weights PpoActor::readWeights(const fs::path& folder) {
  const fs::path file = weightFile(folder);
  const auto expected = [&](const std::map<std::string, std::string>& metadata) {
    const auto format = metadata.find("format");
    if (format == metadata.end()) refuseFormat(file, "not named");
    if (format->second != kFormat) refuseFormat(file, "'" + format->second + "'");
    return tensors();
  };
  return inference::readSafetensors(file, expected).tensors;
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
