// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/rendering/camera_rig.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planning {

/// What the cameras of a vehicle saw at a decision; without a rig for planners that see nothing.
struct CameraViews {
  const rendering::CameraRig* rig = nullptr;  ///< the cameras; null: none
  /// One per camera, in the rig's order; nullptr where none came.
  std::vector<const traffic::CameraImage*> images;

  /// The image of a camera, or nullptr.
  const traffic::CameraImage* find(const std::string& camera) const;
  /// Name of the first camera whose image did not come; empty when all came.
  std::string missing() const;
};

}  // namespace cdiff::planning
