// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What a data set holds, in words and pictures.
#pragma once

#include <filesystem>

#include "e2e_cdiff/ros/dataset_from_bag.h"

namespace cdiff::cli {

/// Writes statistics.json and, where there are shards, samples.html into the data set's folder, and
/// the statistics as a table to the output.
void describeDataset(const std::filesystem::path& folder, const ros::DatasetStatistics& statistics);

}  // namespace cdiff::cli
