// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/dataset_from_bag.h"

#include "collection/session_samples.h"
#include "e2e_cdiff/core/exceptions.h"
#include "ros/bag_session.h"
#include "ros/driving_bag.h"

namespace cdiff::ros {

using core::InputError;

std::vector<learning::DrivingSample> samplesFromBag(const std::filesystem::path& bag,
                                                    const collection::DatasetOptions& options,
                                                    collection::DatasetStatistics& statistics) {
  const collection::DrivenSession session = readBagSession(bag);
  try {
    return collection::samplesOf(session, options, statistics);
  } catch (const InputError& error) {
    throw InputError("bag '" + bag.string() + "': " + error.what());
  }
}

std::vector<learning::DrivingSample> samplesFromDrivingBag(
    const std::filesystem::path& bag, const collection::DriveOptions& drive_options,
    const collection::DatasetOptions& options, collection::DatasetStatistics& statistics) {
  drive_options.validate();
  try {
    const collection::RecordedDrive drive =
        readDrivingBag(bag, drive_options, options.architecture);
    return collection::samplesOf(drive, bag.stem().string(), drive_options, options, statistics);
  } catch (const InputError& error) {
    throw InputError("bag '" + bag.string() + "': " + error.what());
  }
}

}  // namespace cdiff::ros
