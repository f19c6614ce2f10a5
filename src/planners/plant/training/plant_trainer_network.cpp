// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/plant/training/plant_trainer_network.h"

#include <algorithm>

#include "learning/layers.h"

namespace cdiff::planners {
namespace {

using learning::layerNorm;
using learning::linear;
using learning::linearOfRows;
using learning::toTensor;

constexpr float kMasked = -1e9F;

std::int64_t countOfRows(const PlantExample& example) {
  return static_cast<std::int64_t>(1 + example.input.vehicles.size() + example.input.route.size());
}

/// What the tensors of a batch are filled from.
struct BatchRows {
  enum Type { kCls, kVehicle, kSegment };
  explicit BatchRows(std::int64_t longest) : places_of_moment(longest) {}

  std::int64_t places_of_moment;  ///< L
  std::vector<float> values, types, mask, red_light, target, driven;
  std::vector<std::int64_t> padded, unpadded, first, places;
  std::array<std::vector<std::int64_t>, kPlantAttributes> next;

  void add(const PlantExample& example) {
    const PlantInput& input = example.input;
    const auto begin = static_cast<std::int64_t>(padded.size());
    first.push_back(static_cast<std::int64_t>(unpadded.size()));
    addRow({}, kCls);
    for (std::size_t i = 0; i < input.vehicles.size(); ++i) {
      addNext(example.next[i]);
      addRow(input.vehicles[i], kVehicle);
    }
    for (const PlantToken& segment : input.route) addRow(segment, kSegment);
    padded.resize(static_cast<std::size_t>(begin + places_of_moment), 0);
    mask.resize(padded.size(), kMasked);
    red_light.push_back(input.red_light ? 1.0F : 0.0F);
    target.insert(target.end(), input.target.begin(), input.target.end());
    for (const Eigen::Vector2d& place : example.driven) {
      driven.push_back(static_cast<float>(place.x()));
      driven.push_back(static_cast<float>(place.y()));
    }
  }

 private:
  void addRow(const PlantToken& attributes, Type type) {
    const auto row = static_cast<std::int64_t>(unpadded.size());
    unpadded.push_back(static_cast<std::int64_t>(padded.size()));
    padded.push_back(row);
    mask.push_back(0.0F);
    values.insert(values.end(), attributes.begin(), attributes.end());
    for (const Type one : {kCls, kVehicle, kSegment}) types.push_back(one == type ? 1.0F : 0.0F);
  }
  void addNext(const std::array<std::uint8_t, kPlantAttributes>& bins) {
    if (bins[0] == kNoBin) return;
    places.push_back(static_cast<std::int64_t>(unpadded.size()));
    for (std::size_t i = 0; i < next.size(); ++i) next[i].push_back(bins[i]);
  }
};

}  // namespace

PlantBatch plantBatch(const std::vector<const PlantExample*>& examples, const at::Device& device) {
  const auto moments = static_cast<std::int64_t>(examples.size());
  std::int64_t longest = 0;
  for (const PlantExample* example : examples) longest = std::max(longest, countOfRows(*example));
  BatchRows rows(longest);
  for (const PlantExample* example : examples) rows.add(*example);
  const auto count = static_cast<std::int64_t>(rows.unpadded.size());
  const auto indices = [&](const std::vector<std::int64_t>& values) {
    return learning::toIndices(values, {static_cast<std::int64_t>(values.size())}, device);
  };
  PlantBatch batch;
  batch.tokens = toTensor(rows.values, {count, kPlantAttributes}, device);
  batch.types = toTensor(rows.types, {count, 3}, device);
  batch.padded = indices(rows.padded);
  batch.mask = toTensor(rows.mask, {moments, 1, 1, longest}, device);
  batch.unpadded = indices(rows.unpadded);
  batch.first = indices(rows.first);
  batch.red_light = toTensor(rows.red_light, {moments, 1}, device);
  batch.target = toTensor(rows.target, {moments, 2}, device);
  batch.driven = toTensor(rows.driven, {moments, kPlantWaypoints, 2}, device);
  batch.places = indices(rows.places);
  for (std::size_t i = 0; i < rows.next.size(); ++i) batch.next[i] = indices(rows.next[i]);
  return batch;
}

PlantNet::PlantNet(const PlantArchitecture& architecture, std::uint64_t seed)
    : architecture_(architecture), parameters_(core::RandomStream(seed, "plant start")) {
  constexpr double kLearnedVector = 0.02;  // bound of tokens and types that are learned
  parameters_.declareAll(plantTensors(architecture),
                         [](const std::string&) { return kLearnedVector; });
}

/// [R, width].
at::Tensor PlantNet::embed(const PlantBatch& batch) const {
  const at::Tensor is_token = 1.0 - batch.types.narrow(1, 0, 1);
  const at::Tensor learned = at::matmul(
      batch.types,
      at::stack({parameters_("cls"), parameters_("type.vehicle"), parameters_("type.route")}));
  return layerNorm(parameters_, "norm",
                   linearOfRows(parameters_, "token", batch.tokens) * is_token + learned);
}

at::Tensor PlantNet::layer(const std::string& name, const at::Tensor& x, const PlantBatch& batch,
                           at::Tensor& attention) const {
  const std::int64_t moments = batch.mask.size(0);
  const std::int64_t longest = batch.mask.size(3);
  const auto padded = [&](const char* part) {
    const at::Tensor rows = linearOfRows(parameters_, name + part, x);
    return rows.index_select(0, batch.padded).reshape({moments, longest, rows.size(1)});
  };
  const at::Tensor query = padded(".query");
  const at::Tensor key_value = padded(".key_value");
  const learning::Attended attended =
      learning::attend(query, key_value, architecture_.heads, batch.mask);
  attention = attended.weights.select(2, 0).mean(1);
  const at::Tensor mixed = attended.mixed.flatten(0, 1).index_select(0, batch.unpadded);
  const at::Tensor middle = layerNorm(parameters_, name + ".norm1",
                                      x + linearOfRows(parameters_, name + ".output", mixed));
  const at::Tensor hidden = at::gelu(linearOfRows(parameters_, name + ".up", middle));
  return layerNorm(parameters_, name + ".norm2",
                   middle + linearOfRows(parameters_, name + ".down", hidden));
}

at::Tensor PlantNet::gru(const at::Tensor& input, const at::Tensor& state) const {
  const std::vector<at::Tensor> x = linear(parameters_, "gru.input", input).chunk(3, 1);
  const std::vector<at::Tensor> h = linear(parameters_, "gru.state", state).chunk(3, 1);
  const at::Tensor reset = at::sigmoid(x[0] + h[0]);
  const at::Tensor update = at::sigmoid(x[1] + h[1]);
  const at::Tensor proposed = at::tanh(x[2] + reset * h[2]);
  return (1.0 - update) * proposed + update * state;
}

at::Tensor PlantNet::decode(const PlantBatch& batch, const at::Tensor& cls) const {
  at::Tensor state = at::cat({linear(parameters_, "summary", cls), batch.red_light}, 1);
  at::Tensor place = at::zeros_like(batch.target);
  std::vector<at::Tensor> waypoints;
  for (std::int64_t n = 0; n < kPlantWaypoints; ++n) {
    state = gru(at::cat({place / kPlantPlaceScale, batch.target}, 1), state);
    place = place + kPlantStepScale * linear(parameters_, "step", state);
    waypoints.push_back(place);
  }
  return at::stack(waypoints, 1);
}

PlantNet::Result PlantNet::forward(const PlantBatch& batch) const {
  Result result;
  at::Tensor x = embed(batch);
  for (std::int64_t i = 0; i < architecture_.layers; ++i)
    x = layer("layer." + std::to_string(i), x, batch, result.attention);
  result.waypoints = decode(batch, x.index_select(0, batch.first));
  if (batch.places.size(0) == 0) return result;
  const at::Tensor vehicles = x.index_select(0, batch.places);
  for (std::size_t i = 0; i < result.next.size(); ++i)
    result.next[i] =
        linearOfRows(parameters_, std::string("next.") + kPlantAttributeNames[i], vehicles);
  return result;
}

}  // namespace cdiff::planners
