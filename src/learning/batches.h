// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <string>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "learning/samples/dataset.h"

namespace cdiff::learning {

// Stored fields of several samples as tensors. B is the number of samples.

/// A field of several samples.
struct FieldBatch {
  at::Tensor values;  ///< float32 [B, shape of the field]; rows that a sample has not are 0
  at::Tensor counts;  ///< int64 [B]: rows of each sample; undefined where all have the same
};

/// Throws InputError where the samples have no such field or it is a text.
FieldBatch fieldBatch(const Dataset& dataset, const std::vector<std::size_t>& samples,
                      const std::string& field, const at::Device& device);

/// Images [B, 3, H, W], (value / 255 - 0.5) / 0.25, area-averaged to half size for scale 0.5.
at::Tensor imageTensor(const std::vector<const traffic::CameraImage*>& images, double scale,
                       const at::Device& device);

}  // namespace cdiff::learning
