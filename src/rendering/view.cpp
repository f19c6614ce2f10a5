// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/view.h"

#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::rendering {

View::View(const CameraOptions& options, const traffic::Vehicle& vehicle)
    : heading_(geometry::direction(vehicle.state.heading)),
      pitch_cosine_(std::cos(options.pitch * core::kDegree)),
      pitch_sine_(std::sin(options.pitch * core::kDegree)),
      far_distance_(options.far_distance),
      side_tangent_(std::tan(0.5 * options.field_of_view * core::kDegree)),
      side_secant_(std::sqrt(1.0 + side_tangent_ * side_tangent_)) {
  const Eigen::Vector2d mount = vehicle.state.position + options.mount_forward * heading_;
  eye_ = {mount.x(), mount.y(), vehicle.state.elevation + options.mount_height};
}

bool View::maySee(const Eigen::Vector3d& center, double radius) const {
  const Eigen::Vector3d at = toCamera(center);
  if (at.z() < kNearPlane - radius) return false;
  const Eigen::Vector3d offset = center - eye_;
  const double reach = far_distance_ + radius;
  if (offset.x() * offset.x() + offset.y() * offset.y() > reach * reach) return false;
  return std::abs(at.x()) <= at.z() * side_tangent_ + radius * side_secant_;
}

}  // namespace cdiff::rendering
