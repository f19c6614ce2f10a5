// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <string>
#include <vector>

#include "learning/parameters.h"
#include "planners/camera_ego/camera_ego_sizes.h"
#include "planners/camera_ego/training/map_reading.h"

namespace cdiff::planners {

/// Declares the tensors of a camera ego with the values that training starts from: offsets that
/// spread over directions and equal weights for deformable attention (Zhu et al. 2021), heads of
/// classes (*.class.bias) at a probability of 1 %, references uniform over the BEV.
void declareCameraEgo(const std::vector<inference::TensorShape>& tensors, std::int64_t heads,
                      learning::ParameterSet& parameters);

/// The layers of camera egos with gradients, of the tensors and sizes of those at run time; rows
/// are [N, channels], sequences [B, N, channels].
class EgoLayers {
 public:
  EgoLayers(const learning::ParameterSet& parameters, const CameraEgoSizes& sizes)
      : parameters_(parameters), sizes_(sizes) {}

  const at::Tensor& table(const std::string& name) const { return parameters_("table." + name); }
  const at::Tensor& tensor(const std::string& name) const { return parameters_(name); }
  /// W x + b on the last axis.
  at::Tensor linear(const std::string& name, const at::Tensor& x) const;
  at::Tensor norm(const std::string& name, const at::Tensor& x) const;
  /// inference::Mlp.
  at::Tensor mlp(const std::string& name, const at::Tensor& x) const;
  /// inference::FeedForward.
  at::Tensor feedForward(const std::string& name, const at::Tensor& x) const;
  /// inference::DeformableAttention of rows.
  at::Tensor deformable(const std::string& name, const at::Tensor& x, const at::Tensor& maps,
                        const BatchReading& reading) const;
  /// What inference::PreNormAttention adds to x [B, N, width]: to itself where `context` is
  /// undefined; `position` [N or B, N, width] may be undefined.
  at::Tensor attention(const std::string& name, const at::Tensor& x, const at::Tensor& position,
                       const at::Tensor& context) const;
  /// What inference::PreNormFeedForward adds to x.
  at::Tensor mix(const std::string& name, const at::Tensor& x) const {
    return feedForward(name, norm(name + ".norm", x));
  }
  /// QueryLayer: x [B, N, width]; `position` [N, width]; `places` [B, N, 2] in cells of the BEV,
  /// without gradient; `bev` [B x cells, width].
  at::Tensor queryLayer(const std::string& name, const at::Tensor& x, const at::Tensor& position,
                        const at::Tensor& places, const at::Tensor& bev) const;
  const CameraEgoSizes& sizes() const { return sizes_; }

 private:
  const learning::ParameterSet& parameters_;
  CameraEgoSizes sizes_;
};

/// (column, row) in cells of the BEV of places given as shares of its length and width [..., 2].
at::Tensor cellsOfShares(const BevGrid& bev, const at::Tensor& shares);
/// Meters of such places, and back.
at::Tensor metersOfShares(const BevGrid& bev, const at::Tensor& shares);
at::Tensor sharesOfMeters(const BevGrid& bev, const at::Tensor& meters);

}  // namespace cdiff::planners
