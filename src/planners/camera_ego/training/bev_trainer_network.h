// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <string>
#include <vector>

#include "planners/camera_ego/training/ego_layers.h"

namespace cdiff::planners {

/// Moments of B egos as the BEV encoder is given them; C cameras.
struct BevBatch {
  at::Tensor images;  ///< [B x C, 3, H, W]
  at::Tensor motion;  ///< [B, 5]
  /// Of the present; their past BEV, where there is one, is given to `encode`.
  std::vector<std::shared_ptr<const inference::SamplingPlan>> temporal;
  at::Tensor has_past;  ///< [B, 1, 1]: 1 where there is a past BEV
};

/// inference::ImageBackbone and BevEncoder with gradients.
class BevNet {
 public:
  explicit BevNet(const EgoLayers& layers);
  /// `past`: [B x cells, width], or undefined where no moment has one. -> [B x cells, width].
  at::Tensor encode(const BevBatch& batch, const at::Tensor& past) const;

 private:
  at::Tensor features(const at::Tensor& images) const;
  at::Tensor convolved(const std::string& name, const at::Tensor& x, std::int64_t stride,
                       std::int64_t padding) const;
  at::Tensor groupNorm(const std::string& name, const at::Tensor& x) const;
  at::Tensor block(const std::string& name, const at::Tensor& x, std::int64_t stride) const;

  const EgoLayers& layers_;
  std::shared_ptr<const inference::SamplingPlan> camera_plan_;
  std::int64_t cameras_;
};

}  // namespace cdiff::planners
