// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "planners/camera_ego/training/bev_trainer_network.h"
#include "planners/camera_ego/training/ego_layers.h"
#include "planners/vad_mini/vad_mini_weights.h"

namespace cdiff::planners {

/// What the network answers for B moments, with gradients (body frame, SI units). A agents, L
/// lines, P = 10 points.
struct VadMiniAnswer {
  /// By decoder layer, the last one last.
  std::vector<at::Tensor> agent_logits;  ///< [B, A, 1]
  std::vector<at::Tensor> boxes;         ///< [B, A, 10], kBoxNumbers in SI units
  std::vector<at::Tensor> line_logits;   ///< [B, L, kMapKinds]
  std::vector<at::Tensor> lines;         ///< [B, L, P, 2] as shares of the BEV
  at::Tensor ways;                       ///< [B, A, 6 modes, 6, 2], from the agent's center on [m]
  at::Tensor way_logits;                 ///< [B, A, 6 modes]
  at::Tensor plans;                      ///< [B, 6 commands, 6, 2] [m]
};

/// The network of `vad_mini` with gradients; the same function as VadMiniNetwork.
class VadMiniNet {
 public:
  VadMiniNet(const VadMiniArchitecture& architecture, std::uint64_t seed);
  VadMiniNet(const VadMiniNet&) = delete;
  VadMiniNet& operator=(const VadMiniNet&) = delete;

  /// `bev`: of BevNet, [B x cells, width].
  VadMiniAnswer answer(const at::Tensor& bev, std::int64_t samples) const;
  const BevNet& bev() const { return bev_; }
  learning::ParameterSet& parameters() { return parameters_; }
  const VadMiniArchitecture& architecture() const { return architecture_; }

 private:
  /// Features of queries behind the last layer.
  struct Detections {
    at::Tensor agents;   ///< [B, A, width]
    at::Tensor centers;  ///< [B, A, 2], as shares of the BEV, without gradient
    at::Tensor tokens;   ///< of lines [B, L, width]
    at::Tensor nearest;  ///< of lines, their points nearest to the ego [B, L, 2], likewise
  };
  void seeAgents(const at::Tensor& bev, std::int64_t samples, VadMiniAnswer& answer,
                 Detections& seen) const;
  void seeMap(const at::Tensor& bev, std::int64_t samples, VadMiniAnswer& answer,
              Detections& seen) const;
  at::Tensor nearestPoints(const at::Tensor& lines) const;
  /// Agents beside their modes [B, A x 6, 2 width].
  at::Tensor forecast(const Detections& seen, VadMiniAnswer& answer) const;
  void plan(const at::Tensor& bev, const Detections& seen, const at::Tensor& joined,
            VadMiniAnswer& answer) const;
  at::Tensor place(const at::Tensor& shares) const {
    return layers_.mlp("place", 2.0 * shares - 1.0);
  }
  /// x + attention + mix of what follows.
  at::Tensor interact(const std::string& name, const at::Tensor& x, const at::Tensor& position,
                      const at::Tensor& context) const;

  VadMiniArchitecture architecture_;
  learning::ParameterSet parameters_;
  EgoLayers layers_;
  BevNet bev_;
};

}  // namespace cdiff::planners
