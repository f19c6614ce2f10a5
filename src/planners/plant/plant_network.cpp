// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/plant/plant_network.h"

#include <algorithm>

namespace cdiff::planners {
namespace {

using inference::LayerWeights;

constexpr std::int64_t kGruInputs = 4;  // x, y of the last waypoint and of the target point, scaled

std::string layerName(std::int64_t index) { return "layer." + std::to_string(index); }

std::vector<inference::TransformerLayer> makeLayers(const LayerWeights& weights,
                                                    const PlantArchitecture& architecture) {
  std::vector<inference::TransformerLayer> layers;
  for (std::int64_t i = 0; i < architecture.layers; ++i) {
    layers.emplace_back(
        weights, layerName(i),
        inference::TransformerSizes{architecture.width, architecture.heads, architecture.hidden});
  }
  return layers;
}

}  // namespace

std::vector<inference::TensorShape> plantTensors(const PlantArchitecture& architecture) {
  const std::int64_t width = architecture.width;
  inference::TensorList list;
  list.layer("token", {width, kPlantAttributes});
  for (const char* name : {"cls", "type.vehicle", "type.route"}) list.add(name, {width});
  list.norm("norm", width);
  for (std::int64_t i = 0; i < architecture.layers; ++i) {
    const std::string name = layerName(i);
    list.attention(name, width);
    list.norm(name + ".norm1", width);
    list.feedForward(name, width, architecture.hidden);
    list.norm(name + ".norm2", width);
  }
  list.layer("summary", {kPlantSummary, width});
  list.layer("gru.input", {3 * kPlantStates, kGruInputs});
  list.layer("gru.state", {3 * kPlantStates, kPlantStates});
  list.layer("step", {2, kPlantStates});
  for (std::size_t i = 0; i < kPlantBins.size(); ++i)
    list.layer(std::string("next.") + kPlantAttributeNames[i], {kPlantBins[i], width});
  return list.take();
}

PlantNetwork::PlantNetwork(const PlantModel& model, inference::InstructionSet set)
    : architecture_(model.architecture),
      token_({set, model.weights}, "token"),
      cls_(model.weights.at("cls").values),
      vehicle_type_(model.weights.at("type.vehicle").values),
      route_type_(model.weights.at("type.route").values),
      norm_({set, model.weights}, "norm"),
      layers_(makeLayers({set, model.weights}, model.architecture)),
      summary_({set, model.weights}, "summary"),
      gru_({set, model.weights}, "gru"),
      step_({set, model.weights}, "step") {}

/// Writes the tokens of all inputs, one input after the other, each input's CLS token first.
void PlantNetwork::embed(const std::vector<PlantInput>& inputs) {
  begins_ = {0};
  for (const PlantInput& input : inputs) {
    begins_.push_back(begins_.back() + 1 +
                      static_cast<std::int64_t>(input.vehicles.size() + input.route.size()));
  }
  const std::int64_t width = architecture_.width;
  attributes_.resize(begins_.back(), kPlantAttributes);
  tokens_.resize(begins_.back(), width);
  types_.resize(begins_.back(), width);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    std::int64_t row = begins_[i];
    std::fill_n(attributes_.row(row), kPlantAttributes, 0.0F);
    const auto add = [&](const PlantToken& token, const std::vector<float>& type) {
      ++row;
      std::copy(token.begin(), token.end(), attributes_.row(row));
      std::copy(type.begin(), type.end(), types_.row(row));
    };
    for (const PlantToken& token : inputs[i].vehicles) add(token, vehicle_type_);
    for (const PlantToken& token : inputs[i].route) add(token, route_type_);
  }
  token_.apply(attributes_.view(), tokens_.view(), begins_.back());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    std::copy(cls_.begin(), cls_.end(), tokens_.row(begins_[i]));
    std::fill_n(types_.row(begins_[i]), width, 0.0F);
  }
  norm_.apply(tokens_.view(), types_.view(), tokens_.view(), begins_.back());
}

std::vector<PlantOutput> PlantNetwork::forward(const std::vector<PlantInput>& inputs) {
  std::vector<PlantOutput> outputs(inputs.size());
  if (inputs.empty()) return outputs;
  embed(inputs);
  for (std::size_t i = 0; i + 1 < layers_.size(); ++i)
    layers_[i].forward(begins_, tokens_, memory_);
  std::vector<float> attention;
  layers_.back().forwardFirst(begins_, tokens_, memory_, attention);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto first = attention.begin() + begins_[i] + 1;
    outputs[i].attention.assign(first,
                                first + static_cast<std::ptrdiff_t>(inputs[i].vehicles.size()));
  }
  decode(inputs, outputs);
  return outputs;
}

/// Waypoints (frame of each vehicle [m]) from the CLS outputs in memory_.first: the GRU takes the
/// last waypoint and the target point, and each of its states gives the step to the next waypoint.
void PlantNetwork::decode(const std::vector<PlantInput>& inputs,
                          std::vector<PlantOutput>& outputs) {
  const auto moments = static_cast<std::int64_t>(inputs.size());
  state_.resize(moments, kPlantStates);
  gru_input_.resize(moments, kGruInputs);
  change_.resize(moments, 2);
  summary_.apply(memory_.first.view(), state_.view(), moments);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto row = static_cast<std::int64_t>(i);
    state_.row(row)[kPlantSummary] = inputs[i].red_light ? 1.0F : 0.0F;
    gru_input_.row(row)[2] = inputs[i].target[0];
    gru_input_.row(row)[3] = inputs[i].target[1];
  }
  for (std::size_t n = 0; n < static_cast<std::size_t>(kPlantWaypoints); ++n) {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const Eigen::Vector2d last = n == 0 ? Eigen::Vector2d::Zero() : outputs[i].waypoints[n - 1];
      float* input = gru_input_.row(static_cast<std::int64_t>(i));
      input[0] = static_cast<float>(last.x() / kPlantPlaceScale);
      input[1] = static_cast<float>(last.y() / kPlantPlaceScale);
      outputs[i].waypoints[n] = last;
    }
    gru_.step(gru_input_, state_);
    step_.apply(state_.view(), change_.view(), moments);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const float* change = change_.row(static_cast<std::int64_t>(i));
      outputs[i].waypoints[n] += kPlantStepScale * Eigen::Vector2d(change[0], change[1]);
    }
  }
}

}  // namespace cdiff::planners
