// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/training/ppo_networks.h"

#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "learning/layers.h"

namespace cdiff::planners {
namespace {

constexpr double kActorGain = 0.1;
constexpr double kCriticGain = 0.5;
constexpr float kLastBias = 1e-6F;
constexpr const char* kLogDeviation = "log_deviation";

/// Rows [rows, columns] that are orthonormal, times `gain`: Gram-Schmidt on normal draws.
std::vector<float> orthogonalRows(std::size_t rows, std::size_t columns, double gain,
                                  const core::RandomStream& random) {
  std::vector<std::vector<double>> basis;
  for (std::size_t r = 0; r < rows; ++r) {
    std::vector<double> row(columns);
    for (std::size_t c = 0; c < columns; ++c)
      row[c] = random.normal({r}, static_cast<std::uint32_t>(c));
    for (const std::vector<double>& other : basis) {
      double along = 0.0;
      for (std::size_t c = 0; c < columns; ++c) along += row[c] * other[c];
      for (std::size_t c = 0; c < columns; ++c) row[c] -= along * other[c];
    }
    double square = 0.0;
    for (const double value : row) square += value * value;
    for (double& value : row) value /= std::sqrt(square);
    basis.push_back(std::move(row));
  }
  std::vector<float> values;
  for (const std::vector<double>& row : basis) {
    for (const double value : row) values.push_back(static_cast<float>(gain * value));
  }
  return values;
}

void declare(learning::ParameterSet& parameters, std::int64_t outputs, double gain,
             const core::RandomStream& random) {
  for (const PpoLayerShape& layer : ppoLayers(outputs))
    parameters.declareLayer(layer.name, layer.shape);
  std::map<std::string, inference::Tensor> values = parameters.values();
  inference::Tensor& last = values.at("last.weight");
  last.values = orthogonalRows(static_cast<std::size_t>(last.shape[0]),
                               static_cast<std::size_t>(last.shape[1]), gain, random);
  for (float& bias : values.at("last.bias").values) bias = kLastBias;
  parameters.load(values, "start");
}

at::Tensor forward(const learning::ParameterSet& parameters, const at::Tensor& observations) {
  at::Tensor x;
  for (const PpoLayerShape& layer : ppoLayers(1))
    x = linear(parameters, layer.name, x.defined() ? x.relu() : observations);
  return x;
}

}  // namespace

PpoNetworks::PpoNetworks(std::uint64_t seed)
    : actor_(core::RandomStream(seed, "ppo actor")),
      critic_(core::RandomStream(seed, "ppo critic")) {
  const core::RandomStream last(seed, "ppo last layers");
  declare(actor_, static_cast<std::int64_t>(kPpoActions), kActorGain, last);
  actor_.declare(kLogDeviation, {static_cast<std::int64_t>(kPpoActions)}, {});
  declare(critic_, 1, kCriticGain, core::RandomStream(seed, "ppo last layer of the critic"));
}

PpoActor::Weights PpoNetworks::weights() const {
  PpoActor::Weights weights;
  for (const auto& [name, tensor] : actor_.values()) weights["actor." + name] = tensor;
  for (const auto& [name, tensor] : critic_.values()) weights["critic." + name] = tensor;
  return weights;
}

void PpoNetworks::load(const PpoActor::Weights& weights, const std::string& source) {
  std::map<std::string, inference::Tensor> actor;
  std::map<std::string, inference::Tensor> critic;
  for (const auto& [name, tensor] : weights) {
    const std::size_t dot = name.find('.');
    (name.compare(0, dot, "actor") == 0 ? actor : critic)[name.substr(dot + 1)] = tensor;
  }
  actor_.load(actor, source);
  critic_.load(critic, source);
}

at::Tensor PpoNetworks::mean(const at::Tensor& observations) const {
  return forward(actor_, observations);
}

at::Tensor PpoNetworks::logDensity(const at::Tensor& mean, const at::Tensor& actions) const {
  const at::Tensor logarithm = actor_(kLogDeviation);
  const at::Tensor away = (actions - mean) / logarithm.exp();
  return (-0.5 * away.pow(2) - logarithm - 0.5 * std::log(2.0 * core::kPi)).sum(1);
}

at::Tensor PpoNetworks::entropy() const {
  return (actor_(kLogDeviation) + 0.5 + 0.5 * std::log(2.0 * core::kPi)).sum();
}

at::Tensor PpoNetworks::value(const at::Tensor& observations) const {
  return forward(critic_, observations).squeeze(1);
}

}  // namespace cdiff::planners
