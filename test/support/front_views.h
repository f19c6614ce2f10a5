// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Views of a vehicle that has the front camera alone.
#pragma once

#include "e2e_cdiff/planning/camera_views.h"

namespace cdiff::test {

/// With `image`; nullptr: none came.
inline planning::CameraViews frontViews(const traffic::CameraImage* image) {
  static const rendering::CameraRig rig = rendering::frontRig({});
  return {&rig, {image}};
}

}  // namespace cdiff::test
