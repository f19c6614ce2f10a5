// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::rendering {

/// Nothing nearer than this is drawn [m].
constexpr double kNearPlane = 0.25;

/// Where a camera stands: map frame to optical frame (x right, y down, z forward [m]) and on to the
/// image plane (u right, v down from the principal point).
class View {
 public:
  View(const CameraOptions& options, const traffic::Vehicle& vehicle);

  Eigen::Vector3d directionToCamera(const Eigen::Vector3d& direction) const {
    // Sums of products only: a scene mirrored in y gives the negated x and the same y and z, bit by
    // bit.
    const double forward = heading_.x() * direction.x() + heading_.y() * direction.y();
    const double left = heading_.x() * direction.y() - heading_.y() * direction.x();
    return {-left, -(forward * pitch_sine_) - direction.z() * pitch_cosine_,
            forward * pitch_cosine_ - direction.z() * pitch_sine_};
  }
  Eigen::Vector3d toCamera(const Eigen::Vector3d& point) const {
    return directionToCamera(point - eye_);
  }
  /// Whether a ball may be seen: not behind, not beside the view, not beyond the far distance.
  bool maySee(const Eigen::Vector3d& center, double radius) const;
  const Eigen::Vector3d& eye() const { return eye_; }
  double farDistance() const { return far_distance_; }

 private:
  Eigen::Vector3d eye_;
  Eigen::Vector2d heading_;
  double pitch_cosine_;
  double pitch_sine_;
  double far_distance_;
  double side_tangent_;  ///< tangent of half the field of view
  double side_secant_;
};

}  // namespace cdiff::rendering
