// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A drive of one vehicle with a front camera that somebody else recorded, in memory (SI units, a
/// fixed frame of its own).
#pragma once

#include <map>
#include <optional>
#include <string>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/geometry/polyline.h"
#include "e2e_cdiff/traffic/camera_image.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::collection {

/// Topics of the drive's bag, and how samples are taken of it.
struct DriveOptions {
  std::string image;     ///< sensor_msgs/Image or sensor_msgs/CompressedImage
  std::string odometry;  ///< nav_msgs/Odometry: pose in a fixed frame, forward speed as twist x
  std::string control;   ///< e2e_cdiff/ControlAction; empty: actions are inferred from the motion
  std::string path;      ///< nav_msgs/Path in the odometry's frame; empty: the way driven
  double period = 0.5;   ///< between two samples [s]
  double largest_gap = 0.3;  ///< of odometry and controls within a sample [s]

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError when a topic that must be given is not.
  void validate() const;
};

/// By stamp [s].
struct RecordedDrive {
  std::map<double, traffic::CameraImage> images;  ///< of the architecture's size
  std::map<double, traffic::VehicleState> states;
  std::map<double, traffic::ControlAction> controls;
  std::map<double, geometry::Polyline> paths;

  /// State between the two nearest around `time`; nullopt outside, or where they lie farther apart
  /// than `largest_gap`.
  std::optional<traffic::VehicleState> stateAt(double time, double largest_gap) const;
  /// The last control up to `time`, at most `largest_gap` old.
  std::optional<traffic::ControlAction> controlAt(double time, double largest_gap) const;
};

}  // namespace cdiff::collection
