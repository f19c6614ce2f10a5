// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>

#include "e2e_cdiff/core/options.h"

namespace cdiff::rendering {

/// Options of the front camera: pinhole, optical frame x right, y down, z forward; rgb8.
struct CameraOptions {
  std::int64_t width = 160;        ///< [px]
  std::int64_t height = 96;        ///< [px]
  double field_of_view = 90.0;     ///< horizontal [deg]
  double mount_forward = 0.5;      ///< distance ahead of the box's center [m]
  double mount_height = 1.4;       ///< above the road [m]
  double pitch = 6.0;              ///< downwards [deg]
  double far_distance = 90.0;      ///< farthest ground and vehicles that are drawn [m]
  std::int64_t supersampling = 2;  ///< samples per pixel and axis
  bool blind = false;              ///< every pixel mid-gray: shows what an image is worth

  void describe(core::OptionsVisitor& visitor);  ///< visits every option
  /// Throws InputError naming an option that is out of range.
  void validate() const;
};

/// Pinhole intrinsics [px]; the center of the top left pixel is (0, 0).
struct Intrinsics {
  double focal_length = 0.0;  ///< f_x = f_y
  double center_x = 0.0;      ///< of the principal point, to the right
  double center_y = 0.0;      ///< of the principal point, downward
};

/// f = width / 2 / tan(field_of_view / 2); center ((width - 1) / 2, (height - 1) / 2).
Intrinsics intrinsicsOf(const CameraOptions& options);

}  // namespace cdiff::rendering
