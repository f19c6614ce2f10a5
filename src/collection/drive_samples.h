// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Training samples from a drive that somebody else recorded (SI units; rows as in
/// traffic/rollout.h).
#pragma once

#include <string>
#include <vector>

#include "collection/dataset_options.h"
#include "collection/dataset_statistics.h"
#include "collection/recorded_drive.h"

namespace cdiff::collection {

/// Samples of the drive called `name` in order of time; each minute is a session of its own, so
/// that whole minutes are held out in training. An image gives one if odometry (and controls, where
/// named) goes on for the whole horizon, forwards: what goes back is dropped, for the vehicle
/// dynamics knows no reverse. Actions that are inferred are those of the vehicle dynamics
/// (dynamics/action_inference.h). Throws InputError where there is no image or no sample.
std::vector<learning::DrivingSample> samplesOf(const RecordedDrive& drive, const std::string& name,
                                               const DriveOptions& drive_options,
                                               const DatasetOptions& options,
                                               DatasetStatistics& statistics);

}  // namespace cdiff::collection
