// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <memory>
#include <vector>

#include "inference/deformable_attention.h"

namespace cdiff::planners {

// What inference::readMaps computes, with gradients, for B samples at once.

/// How each sample's queries read its maps; the samples' queries and maps lie one after the other.
struct BatchReading {
  inference::DeformableSizes sizes;
  inference::MapGrid grid;
  std::int64_t maps = 1;  ///< of a sample
  /// One for each sample, of the same number of queries.
  std::vector<std::shared_ptr<const inference::SamplingPlan>> plans;
};

/// values [B x maps x cells, width], offsets [B x queries, blocks x heads x points x 2], weights [B
/// x queries, blocks x heads x points] -> [B x queries, width]. On processors by loops of its own,
/// on other devices by readMapsByGridSample.
at::Tensor readMapsOf(const BatchReading& reading, const at::Tensor& values,
                      const at::Tensor& offsets, const at::Tensor& weights);

/// The same by libtorch's grid_sample.
at::Tensor readMapsByGridSample(const BatchReading& reading, const at::Tensor& values,
                                const at::Tensor& offsets, const at::Tensor& weights);

}  // namespace cdiff::planners
