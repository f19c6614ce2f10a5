// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <vector>

#include "collection/training_samples.h"

namespace cdiff::ros {

// A recorded session, read from its bag.

/// Throws InputError naming the file and what is wrong with it.
collection::DrivenSession readSessionBag(const std::filesystem::path& bag);

// Training samples from bags: of sessions of ours, and of drives that someone else recorded.

/// Samples of a session's bag (collection/training_samples.h). Throws InputError for a file that is
/// no bag, holds no session of ours, no images, images of another size, or decisions that are not
/// 0.1 s apart; the texts name the file.
std::vector<learning::DrivingSample> samplesFromBag(const std::filesystem::path& bag,
                                                    const collection::DatasetOptions& options,
                                                    collection::DatasetStatistics& statistics);

/// Samples of a drive's bag (collection/training_samples.h), called as the file without its
/// extension. Throws InputError naming the file and what readDrivingBag or samplesOf finds.
std::vector<learning::DrivingSample> samplesFromDrivingBag(
    const std::filesystem::path& bag, const collection::DriveOptions& drive_options,
    const collection::DatasetOptions& options, collection::DatasetStatistics& statistics);

}  // namespace cdiff::ros
