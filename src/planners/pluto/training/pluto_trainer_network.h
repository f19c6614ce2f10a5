// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "learning/parameters.h"
#include "planners/pluto/training/pluto_batch.h"

namespace cdiff::planners {

/// Which residual steps of the layers are left out for a moment in training (stochastic depth,
/// Huang et al. 2016): factors [B, 1, 1] by layer, 0 or 1 / (1 - share); empty: none.
using LayerFactors = std::vector<at::Tensor>;

/// The network of `pluto` with gradients, of the tensors that plutoTensors names: the same function
/// as PlutoNetwork.
class PlutoNet {
 public:
  PlutoNet(const PlutoArchitecture& architecture, std::uint64_t seed);

  /// What the layers make of a batch, before the heads.
  struct Features {
    at::Tensor tokens;   ///< [B, 1 + A + P, width], the vehicle's own first
    at::Tensor queries;  ///< [B, R x 12, width]: what the heads of candidates read
  };
  Features forward(const PlutoBatch& batch, const LayerFactors& factors = {}) const;

  // Heads.

  /// Trajectories of queries [N, width] -> [N, 80, 6].
  at::Tensor trajectories(const at::Tensor& queries) const;
  /// Logits of queries [N, width] -> [N].
  at::Tensor scores(const at::Tensor& queries) const;
  /// Plans without a reference line, of own tokens [B, width] -> [B, 80, 4].
  at::Tensor freePlans(const at::Tensor& own) const;
  /// Futures of agents' tokens [N, width] -> [N, 80, 6], each in the agent's own frame.
  at::Tensor forecasts(const at::Tensor& agents) const;
  /// Directions of own tokens for the contrastive loss [B, width], of length 1.
  at::Tensor contrasts(const at::Tensor& own) const;

  const PlutoArchitecture& architecture() const { return architecture_; }
  learning::ParameterSet& parameters() { return parameters_; }
  const learning::ParameterSet& parameters() const { return parameters_; }

 private:
  at::Tensor table(const std::string& name) const { return parameters_("table." + name); }
  at::Tensor rows(const std::string& table_name, const at::Tensor& indices) const;
  at::Tensor dense(const std::string& name, const at::Tensor& x) const;
  at::Tensor mlp(const std::string& name, const at::Tensor& x) const;
  at::Tensor pointNet(const std::string& name, const at::Tensor& points,
                      const at::Tensor& mask) const;
  at::Tensor position(const at::Tensor& poses) const;
  at::Tensor own(const PlutoBatch& batch) const;
  at::Tensor agents(const PlutoBatch& batch) const;
  at::Tensor polygons(const PlutoBatch& batch) const;
  at::Tensor attention(const std::string& name, const at::Tensor& x, const at::Tensor& position,
                       const at::Tensor& context, const at::Tensor& mask) const;
  at::Tensor feedForward(const std::string& name, const at::Tensor& x) const;
  at::Tensor decode(const PlutoBatch& batch, const at::Tensor& tokens) const;

  PlutoArchitecture architecture_;
  learning::ParameterSet parameters_;
};

}  // namespace cdiff::planners
