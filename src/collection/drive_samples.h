// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "collection/collection_options.h"
#include "collection/dataset_statistics.h"
#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::collection {

/// Topics of the drive's bag, and how samples are taken of it.
struct DriveOptions {
  std::string image;     ///< sensor_msgs/Image or sensor_msgs/CompressedImage
  std::string odometry;  ///< nav_msgs/Odometry: pose in a fixed frame, forward speed as twist x
  std::string control;   ///< e2e_cdiff/ControlAction; empty: actions are inferred from the motion
  std::string path;      ///< nav_msgs/Path in the odometry's frame; empty: the path driven
  double period = 0.5;   ///< between two samples [s]
  double largest_gap = 0.3;  ///< largest gap of odometry and controls within a sample [s]

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError when a topic that must be given is not.
  void validate() const;
};

/// A drive of one vehicle with a front camera that someone else recorded, in memory: images,
/// states, controls and paths by their stamps [s] (SI units, a fixed frame of its own).
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

// Training samples from a drive that someone else recorded (SI units; rows as in
// traffic/vehicle.h).

/// Samples of the drive called `name` in order of time; each minute is a session of its own, so
/// that whole minutes are held out in training. An image gives one if odometry (and controls, where
/// named) goes on for the whole horizon, forward: reversing is dropped, because the vehicle
/// dynamics cannot reverse. Actions that are inferred are those of the vehicle dynamics
/// (dynamics/action_rollout.h). Throws InputError where there is no image or no sample.
std::vector<learning::DrivingSample> samplesOf(const RecordedDrive& drive, const std::string& name,
                                               const DriveOptions& drive_options,
                                               const DatasetOptions& options,
                                               DatasetStatistics& statistics);

}  // namespace cdiff::collection
