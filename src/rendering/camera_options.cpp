// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/rendering/camera_options.h"

#include <cmath>

#include "core/option_fields.h"
#include "e2e_cdiff/core/angle.h"

namespace cdiff::rendering {

void CameraOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"width", "px", "Width of the image."}, width, 1, 4096);
  visitor.integer({"height", "px", "Height of the image."}, height, 1, 4096);
  visitor.number({"field_of_view", "deg", "Horizontal field of view."}, field_of_view, 10.0, 170.0);
  visitor.number({"mount_forward", "m", "Mounting point ahead of the box's centre."}, mount_forward,
                 -20.0, 20.0);
  visitor.number({"mount_height", "m", "Mounting point above the road."}, mount_height, 0.2, 10.0);
  visitor.number({"pitch", "deg", "Downward tilt."}, pitch, -45.0, 45.0);
  visitor.number({"far_distance", "m", "Farthest ground and vehicles that are drawn."},
                 far_distance, 5.0, 1000.0);
  visitor.integer({"supersampling", "", "Samples per pixel and axis."}, supersampling, 1, 8);
  visitor.flag({"blind", "", "Whether every pixel is mid-grey, to see what an image is worth."},
               blind);
}

void CameraOptions::validate() const { core::requireRanges(*this, "camera"); }

Intrinsics intrinsicsOf(const CameraOptions& options) {
  Intrinsics intrinsics;
  const double width = static_cast<double>(options.width);
  intrinsics.focal_length = 0.5 * width / std::tan(options.field_of_view * core::kPi / 360.0);
  intrinsics.center_x = 0.5 * (width - 1.0);
  intrinsics.center_y = 0.5 * (static_cast<double>(options.height) - 1.0);
  return intrinsics;
}

}  // namespace cdiff::rendering
