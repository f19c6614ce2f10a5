// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What a data set holds, in words and pictures.
#pragma once

#include <filesystem>
#include <string>

#include "collection/dataset_statistics.h"

namespace cdiff::collection {

/// Writes statistics.json and, where there are shards, samples.html into the data set's folder, and
/// the statistics as a table to the output.
void describeDataset(const std::filesystem::path& folder, const DatasetStatistics& statistics);

/// Names on standard error each "session" or "bag" (`kind`) that gave no sample, with what became
/// of its images and, where they lie too near its end, the `remedy` ("longer bags"). Throws
/// InputError when none gave any.
void requireSamples(const StatisticsByName& statistics, const std::string& kind,
                    const std::string& remedy);

}  // namespace cdiff::collection
