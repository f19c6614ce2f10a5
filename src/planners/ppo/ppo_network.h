// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planners/ppo/ppo_rules.h"
#include "planners/weight_files.h"

namespace cdiff::planners {

inline constexpr WeightKind kPpo = {"ppo", "ppo.safetensors", "e2e_cdiff.ppo.1", "--suite FOLDER"};

/// A dense layer y = W x + b in float32. Sums run over the inputs in their order, so the result
/// does not depend on compiler or instruction set as long as multiplication and addition are not
/// fused.
class PpoLayer {
 public:
  /// `weight` [outputs, inputs], `bias` [outputs].
  PpoLayer(const inference::Tensor& weight, const inference::Tensor& bias);
  /// y of x. Inputs that are 0 cost nothing.
  std::vector<float> apply(const std::vector<float>& x) const;

 private:
  std::vector<float> weight_;  ///< [inputs, outputs]
  std::vector<float> bias_;
};

/// A layer of actor or critic: its name, and the shape [outputs, inputs] of its weight.
struct PpoLayerShape {
  const char* name;
  std::vector<std::int64_t> shape;
};

/// The layers of a network with ReLU between them, 24-256-256-`outputs`: the actor that drives, the
/// networks that are trained (training/ppo_networks.h) and the weight file follow from it.
std::vector<PpoLayerShape> ppoLayers(std::int64_t outputs);

/// The actor of PPO, of two outputs, and a standard deviation that does not depend on the
/// observation. The weight file also holds the critic, of one output, for training to go on from.
class PpoActor {
 public:
  using Weights = WeightTensors;

  /// Names and shapes of the weights of actor ("actor.") and critic ("critic.").
  static std::vector<inference::TensorShape> tensors();
  /// See planners::readWeights.
  static Weights readWeights(const std::filesystem::path& folder);

  /// `weights` are those that tensors() names; the critic's are not looked at.
  explicit PpoActor(const Weights& weights);

  /// Mean of the Gaussian that training samples from.
  PpoAction mean(const PpoObservation& observation) const;
  /// The action that drives outside of training: tanh(mean).
  PpoAction act(const PpoObservation& observation) const;
  /// Standard deviation of the Gaussian, by action.
  const PpoAction& deviation() const { return deviation_; }

 private:
  std::vector<PpoLayer> layers_;
  PpoAction deviation_{};
};

}  // namespace cdiff::planners
