// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <vector>

#include "learning/parameters.h"
#include "planners/plant/training/plant_samples.h"

namespace cdiff::planners {

/// Several moments as tensors. B moments, T tokens (vehicles, then route segments, then padding).
struct PlantBatch {
  at::Tensor tokens;     ///< [B, T, 6]
  at::Tensor types;      ///< [B, T, 2]: 1 for vehicles, 1 for route segments; 0 in the padding
  at::Tensor mask;       ///< [B, 1, 1, 1 + T]: 0, or -1e9 on the padding; CLS first
  at::Tensor red_light;  ///< [B, 1]
  at::Tensor target;     ///< [B, 2]
  at::Tensor driven;     ///< [B, 4, 2] [m]
  at::Tensor
      places;  ///< int64 [N]: rows of the vehicle tokens that are there 0.5 s later, of B x (1 + T)
  std::array<at::Tensor, kPlantAttributes> next;  ///< int64 [N]: their bins
};

PlantBatch plantBatch(const std::vector<const PlantExample*>& examples, const at::Device& device);

/// PlanT's network with gradients, of the tensors that plantTensors names: the same function as
/// PlantNetwork.
class PlantNet {
 public:
  PlantNet(const PlantArchitecture& architecture, std::uint64_t seed);

  /// What the network makes of a batch.
  struct Result {
    at::Tensor waypoints;                           ///< [B, 4, 2] [m]
    std::array<at::Tensor, kPlantAttributes> next;  ///< logits [N, bins] of the batch's `places`
    at::Tensor attention;  ///< [B, 1 + T]: the last layer's of CLS, mean over heads
  };
  Result forward(const PlantBatch& batch) const;

  learning::ParameterSet& parameters() { return parameters_; }
  const learning::ParameterSet& parameters() const { return parameters_; }

 private:
  at::Tensor embed(const PlantBatch& batch) const;
  at::Tensor layer(const std::string& name, const at::Tensor& x, const at::Tensor& mask,
                   at::Tensor& attention) const;
  at::Tensor norm(const std::string& name, const at::Tensor& x) const;
  at::Tensor decode(const PlantBatch& batch, const at::Tensor& cls) const;
  at::Tensor gru(const at::Tensor& input, const at::Tensor& state) const;

  PlantArchitecture architecture_;
  learning::ParameterSet parameters_;
};

}  // namespace cdiff::planners
