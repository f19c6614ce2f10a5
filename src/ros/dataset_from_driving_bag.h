// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Training samples from a bag that somebody else recorded: one vehicle with a front camera and
/// odometry, whatever its topics are called (SI units; rows as in traffic/rollout.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "ros/dataset_from_bag.h"

namespace cdiff::ros {

/// Topics of the bag, and how it is read.
struct DrivingBagOptions {
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

/// Samples in order of time; each minute is a session of its own, so that whole minutes are held
/// out in training. An image gives one if odometry (and controls, where named) goes on for the
/// whole horizon, forwards: what goes back is dropped, for the vehicle dynamics knows no reverse.
/// Images are cut to the aspect of `options.architecture`'s and made as small; they should see some
/// 90 degrees. Stamps are those of the headers. Actions that are inferred are those of the vehicle
/// dynamics (dynamics/action_inference.h). Throws InputError naming the file and: a topic that the
/// bag lacks (and what it has), one of another type, a message that is broken or has no
/// orientation, a path in another frame, an encoding that is no colour, no sample at all.
std::vector<learning::DrivingSample> samplesFromDrivingBag(const std::filesystem::path& bag,
                                                           const DrivingBagOptions& topics,
                                                           const DatasetOptions& options,
                                                           DatasetStatistics& statistics);

}  // namespace cdiff::ros
