// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "collection/collection_options.h"
#include "collection/dataset_statistics.h"
#include "collection/drive_samples.h"
#include "collection/session_samples.h"

namespace cdiff::node_graph {

// A recorded session, read from its bag.

/// Throws InputError naming the file and what is wrong with it.
collection::DrivenSession readSessionBag(const std::filesystem::path& bag);

// Training samples from bags: of sessions of ours, and of drives that someone else recorded.

/// Samples of a session's bag (collection/session_samples.h). Throws InputError for a file that is
/// no bag, holds no session of ours, no images, images of another size, or decisions that are not
/// 0.1 s apart; the texts name the file.
std::vector<learning::DrivingSample> samplesFromBag(const std::filesystem::path& bag,
                                                    const collection::DatasetOptions& options,
                                                    collection::DatasetStatistics& statistics);

/// Samples of a drive's bag (collection/drive_samples.h), called as the file without its
/// extension. Throws InputError naming the file and what readDrivingBag or samplesOf finds.
std::vector<learning::DrivingSample> samplesFromDrivingBag(
    const std::filesystem::path& bag, const collection::DriveOptions& drive_options,
    const collection::DatasetOptions& options, collection::DatasetStatistics& statistics);

// Collecting data through bags: a session is driven and recorded, or bags of others are taken, and
// each bag becomes a shard of samples in the data set's folder.

/// Drives the session and writes its bag, and, where it has images, its shard and statistics. A
/// session without samples leaves no shard, and is driven again when it is asked for again. Throws
/// core::Interrupted after `stop`, SimulatorError for a session that ends with an error.
void collectSession(const collection::CollectRequest& request, const std::atomic<bool>& stop);

/// Bags of drives that someone else recorded.
struct BagRequest {
  std::vector<std::string> bags;
  std::string topics;             ///< YAML file: collection::DriveOptions
  std::filesystem::path results;  ///< folder of the data set
};

/// Writes shards/NAME.shard for each bag and returns what is in each, by NAME. Throws InputError,
/// also for two bags of one name; shards written before stay.
collection::StatisticsByName collectBags(const BagRequest& request);

}  // namespace cdiff::node_graph
