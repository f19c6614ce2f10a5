// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/camera_views.h"

#include <algorithm>

namespace cdiff::planning {

const traffic::CameraImage* CameraViews::find(const std::string& camera) const {
  if (rig == nullptr) return nullptr;
  for (std::size_t i = 0; i < std::min(images.size(), rig->cameras.size()); ++i) {
    if (rig->cameras[i].name == camera) return images[i];
  }
  return nullptr;
}

std::string CameraViews::missing() const {
  if (rig == nullptr) return "";
  for (const rendering::RigCamera& camera : rig->cameras) {
    if (find(camera.name) == nullptr) return camera.name;
  }
  return "";
}

}  // namespace cdiff::planning
