// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/plant/training/plant_net.h"

#include <algorithm>
#include <cmath>

namespace cdiff::planners {
namespace {

using learning::linear;
using learning::toTensor;

constexpr double kEpsilon = 1e-5;
constexpr float kMasked = -1e9F;

std::int64_t countOfTokens(const PlantExample& example) {
  return static_cast<std::int64_t>(example.input.vehicles.size() + example.input.route.size());
}

/// Rows of a batch, padded to its longest moment.
struct PaddedRows {
  std::int64_t moments;
  std::int64_t tokens;
  std::vector<float> values, types, mask, red_light, target, driven;
  std::vector<std::int64_t> places;
  std::array<std::vector<std::int64_t>, kPlantAttributes> next;

  PaddedRows(std::int64_t moments_count, std::int64_t tokens_count)
      : moments(moments_count),
        tokens(tokens_count),
        values(static_cast<std::size_t>(moments * tokens * kPlantAttributes)),
        types(static_cast<std::size_t>(moments * tokens * 2)),
        mask(static_cast<std::size_t>(moments * (tokens + 1)), kMasked) {}

  void add(std::int64_t moment, const PlantExample& example) {
    const PlantInput& input = example.input;
    mask[static_cast<std::size_t>(moment * (tokens + 1))] = 0.0F;
    std::int64_t token = 0;
    for (std::size_t i = 0; i < input.vehicles.size(); ++i) {
      addToken(moment, token, input.vehicles[i], 0);
      addNext(moment * (tokens + 1) + 1 + token, example.next[i]);
      ++token;
    }
    for (const PlantToken& segment : input.route) addToken(moment, token++, segment, 1);
    red_light.push_back(input.red_light ? 1.0F : 0.0F);
    target.insert(target.end(), input.target.begin(), input.target.end());
    for (const Eigen::Vector2d& place : example.driven) {
      driven.push_back(static_cast<float>(place.x()));
      driven.push_back(static_cast<float>(place.y()));
    }
  }

 private:
  void addToken(std::int64_t moment, std::int64_t token, const PlantToken& attributes,
                std::int64_t type) {
    const std::int64_t row = moment * tokens + token;
    std::copy(attributes.begin(), attributes.end(), values.begin() + row * kPlantAttributes);
    types[static_cast<std::size_t>(2 * row + type)] = 1.0F;
    mask[static_cast<std::size_t>(moment * (tokens + 1) + 1 + token)] = 0.0F;
  }
  void addNext(std::int64_t row, const std::array<std::uint8_t, kPlantAttributes>& bins) {
    if (bins[0] == kNoBin) return;
    places.push_back(row);
    for (std::size_t i = 0; i < next.size(); ++i) next[i].push_back(bins[i]);
  }
};

at::Tensor indexTensor(const std::vector<std::int64_t>& values, const at::Device& device) {
  at::Tensor tensor = at::empty({static_cast<std::int64_t>(values.size())}, at::kLong);
  std::copy(values.begin(), values.end(), tensor.data_ptr<std::int64_t>());
  return tensor.to(device);
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

PlantBatch plantBatch(const std::vector<const PlantExample*>& examples, const at::Device& device) {
  const auto moments = static_cast<std::int64_t>(examples.size());
  std::int64_t tokens = 0;
  for (const PlantExample* example : examples) tokens = std::max(tokens, countOfTokens(*example));
  PaddedRows rows(moments, tokens);
  for (std::int64_t i = 0; i < moments; ++i) rows.add(i, *examples[static_cast<std::size_t>(i)]);
  PlantBatch batch;
  batch.tokens = toTensor(rows.values, {moments, tokens, kPlantAttributes}, device);
  batch.types = toTensor(rows.types, {moments, tokens, 2}, device);
  batch.mask = toTensor(rows.mask, {moments, 1, 1, tokens + 1}, device);
  batch.red_light = toTensor(rows.red_light, {moments, 1}, device);
  batch.target = toTensor(rows.target, {moments, 2}, device);
  batch.driven = toTensor(rows.driven, {moments, kPlantWaypoints, 2}, device);
  batch.places = indexTensor(rows.places, device);
  for (std::size_t i = 0; i < rows.next.size(); ++i)
    batch.next[i] = indexTensor(rows.next[i], device);
  return batch;
}

PlantNet::PlantNet(const PlantArchitecture& architecture, std::uint64_t seed)
    : architecture_(architecture), parameters_(core::RandomStream(seed, "plant start")) {
  constexpr double kLearnedVector = 0.02;      // bound of tokens and types that are learned
  std::map<std::string, std::int64_t> inputs;  // of layers, by name
  for (const inference::TensorShape& tensor : plantTensors(architecture)) {
    const std::string& name = tensor.name;
    if (endsWith(name, ".weight") && tensor.shape.size() == 2) {
      parameters_.declareLayer(name.substr(0, name.size() - 7), tensor.shape);
    } else if (endsWith(name, ".weight")) {
      parameters_.declareNorm(name.substr(0, name.size() - 7), tensor.shape[0]);
    } else if (!endsWith(name, ".bias")) {
      parameters_.declare(name, tensor.shape, {learning::Start::Kind::kUniform, kLearnedVector});
    }
  }
}

at::Tensor PlantNet::norm(const std::string& name, const at::Tensor& x) const {
  return at::layer_norm(x, {architecture_.width}, parameters_(name + ".weight"),
                        parameters_(name + ".bias"), kEpsilon);
}

/// [B, 1 + T, width].
at::Tensor PlantNet::embed(const PlantBatch& batch) const {
  const std::int64_t moments = batch.tokens.size(0);
  const std::int64_t tokens = batch.tokens.size(1);
  const std::int64_t width = architecture_.width;
  const at::Tensor cls = parameters_("cls").expand({moments, 1, width});
  if (tokens == 0) return norm("norm", cls);
  const at::Tensor embedded =
      linear(parameters_, "token", batch.tokens.reshape({moments * tokens, kPlantAttributes}));
  const at::Tensor types = batch.types.select(2, 0).unsqueeze(2) * parameters_("type.vehicle") +
                           batch.types.select(2, 1).unsqueeze(2) * parameters_("type.route");
  return norm("norm", at::cat({cls, embedded.reshape({moments, tokens, width}) + types}, 1));
}

at::Tensor PlantNet::layer(const std::string& name, const at::Tensor& x, const at::Tensor& mask,
                           at::Tensor& attention) const {
  const std::int64_t moments = x.size(0);
  const std::int64_t rows = x.size(1);
  const std::int64_t width = architecture_.width;
  const std::int64_t heads = architecture_.heads;
  const std::int64_t head_width = width / heads;
  const auto byHead = [&](const at::Tensor& values) {
    return values.reshape({moments, rows, heads, head_width}).transpose(1, 2).contiguous();
  };
  const at::Tensor flat = x.reshape({moments * rows, width});
  const at::Tensor query = byHead(linear(parameters_, name + ".query", flat));
  const at::Tensor both = linear(parameters_, name + ".key_value", flat);
  const at::Tensor key = byHead(both.narrow(1, 0, width));
  const at::Tensor value = byHead(both.narrow(1, width, width));
  const at::Tensor scores =
      at::matmul(query, key.transpose(2, 3)) / std::sqrt(static_cast<double>(head_width)) + mask;
  const at::Tensor weights = at::softmax(scores, -1);
  attention = weights.select(2, 0).mean(1);
  const at::Tensor mixed =
      at::matmul(weights, value).transpose(1, 2).reshape({moments * rows, width});
  const at::Tensor middle =
      norm(name + ".norm1", flat + linear(parameters_, name + ".output", mixed));
  const at::Tensor hidden = at::gelu(linear(parameters_, name + ".up", middle));
  return norm(name + ".norm2", middle + linear(parameters_, name + ".down", hidden))
      .reshape({moments, rows, width});
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
    x = layer("layer." + std::to_string(i), x, batch.mask, result.attention);
  result.waypoints = decode(batch, x.select(1, 0));
  if (batch.places.size(0) == 0) return result;
  const at::Tensor vehicles =
      x.reshape({x.size(0) * x.size(1), architecture_.width}).index_select(0, batch.places);
  for (std::size_t i = 0; i < result.next.size(); ++i)
    result.next[i] = linear(parameters_, std::string("next.") + kPlantAttributeNames[i], vehicles);
  return result;
}

}  // namespace cdiff::planners
