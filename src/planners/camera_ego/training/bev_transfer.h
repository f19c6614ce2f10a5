// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "planners/camera_ego/camera_ego_sizes.h"
#include "planners/weight_files.h"

namespace cdiff::planners {

/// The trained BEV encoder of a camera ego, for another one to start from.
struct TrainedBevEncoder {
  CameraEgoSizes sizes;
  const WeightTensors& weights;  ///< with those of other parts, which are left alone
  std::string source;            ///< for messages
};

/// Its tensors for sizes whose grid may be another: the learned rows of cells are read, bilinearly,
/// at the centers of the new cells, and at the nearest place of the old grid where they lie beyond;
/// offsets between BEVs, which count in cells, reach as far in meters as before; all others stay as
/// they are. Throws InputError where anything but the grid differs.
WeightTensors bevEncoderFor(const CameraEgoSizes& sizes, const TrainedBevEncoder& trained);

}  // namespace cdiff::planners
