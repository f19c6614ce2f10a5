// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include "learning/parameters.h"
#include "planners/ppo/ppo_network.h"

namespace cdiff::planners {

/// Actor and critic of PPO with gradients: 24-256-256-2 and 24-256-256-1 with ReLU, the same as
/// PpoActor computes. Their last layers start orthogonal with gain 0.1 and 0.5, the logarithms of
/// the actor's deviations as 0, all else as torch's linear layers.
class PpoNetworks {
 public:
  explicit PpoNetworks(std::uint64_t seed);

  learning::ParameterSet& actor() { return actor_; }
  learning::ParameterSet& critic() { return critic_; }
  /// All weights by the names of PpoActor::tensors().
  PpoActor::Weights weights() const;
  /// Throws InputError naming `source` for weights that do not fit.
  void load(const PpoActor::Weights& weights, const std::string& source);

  /// Means of the Gaussian [B, 2] for observations [B, 24].
  at::Tensor mean(const at::Tensor& observations) const;
  /// Logarithms of its densities [B] at actions [B, 2], given the means.
  at::Tensor logDensity(const at::Tensor& mean, const at::Tensor& actions) const;
  /// Its entropy, the same for every observation [].
  at::Tensor entropy() const;
  /// Expected returns [B].
  at::Tensor value(const at::Tensor& observations) const;

 private:
  learning::ParameterSet actor_;
  learning::ParameterSet critic_;
};

}  // namespace cdiff::planners
