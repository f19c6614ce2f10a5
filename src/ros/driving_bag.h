// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A foreign bag of one vehicle in memory, by time.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "e2e_cdiff/geometry/polyline.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "ros/dataset_from_driving_bag.h"

namespace cdiff::ros {

struct DrivingBag {
  std::map<double, traffic::CameraImage> images;  ///< by stamp [s], of the architecture's size
  std::map<double, traffic::VehicleState> states;
  std::map<double, traffic::ControlAction> controls;
  std::map<double, geometry::Polyline> paths;

  /// State between the two nearest around `time`; nullopt outside, or where they lie farther apart
  /// than `largest_gap`.
  std::optional<traffic::VehicleState> stateAt(double time, double largest_gap) const;
  /// The last control up to `time`, at most `largest_gap` old.
  std::optional<traffic::ControlAction> controlAt(double time, double largest_gap) const;
};

/// Throws InputError as samplesFromDrivingBag does, without the file's name.
DrivingBag readDrivingBag(const std::filesystem::path& file, const DrivingBagOptions& topics,
                          const diffusion::Architecture& architecture);

}  // namespace cdiff::ros
