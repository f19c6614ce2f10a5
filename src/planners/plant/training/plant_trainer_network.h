// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <vector>

#include "learning/parameters.h"
#include "planners/plant/training/plant_samples.h"

namespace cdiff::planners {

/// Several moments as tensors. B moments; R rows: the tokens of all moments one after the other,
/// each moment's CLS first, then vehicles, then route segments; L: rows of the longest moment.
struct PlantBatch {
  at::Tensor tokens;     ///< [R, 6]; 0 for CLS
  at::Tensor types;      ///< [R, 3]: 1 in the column of CLS, vehicle or route segment
  at::Tensor padded;     ///< int64 [B x L]: row of each place; 0 where a moment has none
  at::Tensor mask;       ///< [B, 1, 1, L]: 0, or -1e9 where a moment has no row
  at::Tensor unpadded;   ///< int64 [R]: place of each row
  at::Tensor first;      ///< int64 [B]: row of each moment's CLS
  at::Tensor red_light;  ///< [B, 1]
  at::Tensor target;     ///< [B, 2]
  at::Tensor driven;     ///< [B, 4, 2] [m]
  at::Tensor places;     ///< int64 [N]: rows of the vehicles that are still there 0.5 s later
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
    at::Tensor attention;  ///< [B, L]: the last layer's of CLS, mean over heads
  };
  Result forward(const PlantBatch& batch) const;

  learning::ParameterSet& parameters() { return parameters_; }
  const learning::ParameterSet& parameters() const { return parameters_; }

 private:
  at::Tensor embed(const PlantBatch& batch) const;
  at::Tensor layer(const std::string& name, const at::Tensor& x, const PlantBatch& batch,
                   at::Tensor& attention) const;
  at::Tensor decode(const PlantBatch& batch, const at::Tensor& cls) const;
  at::Tensor gru(const at::Tensor& input, const at::Tensor& state) const;

  PlantArchitecture architecture_;
  learning::ParameterSet parameters_;
};

}  // namespace cdiff::planners
