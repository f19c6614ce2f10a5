// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace cdiff::collection {

/// What the sessions or bags of a data set gave: images, samples and kinds of driving, counted.
/// What is in a data set; sums, so that those of several bags add up.
struct DatasetStatistics {
  std::uint64_t images = 0;
  std::uint64_t samples = 0;
  std::map<std::string, std::uint64_t> dropped;       ///< images that yielded no sample, by reason
  std::map<std::string, std::uint64_t> maneuvers;     ///< samples: straight, left, right, other
  std::map<std::string, std::uint64_t> stop_reasons;  ///< samples: none, light, leader, ...
  /// Samples: standing, starting, stopping, recovering, displaced, off_road, off_course,
  /// in_junction.
  std::map<std::string, std::uint64_t> kinds;
  std::array<std::uint64_t, 8> speeds{};  ///< samples by speed, 2 m/s a bin, the last open
  double steer_sum = 0.0;                 ///< sum of each sample's mean |steer|
  std::uint64_t contacts = 0;             ///< contacts of driven vehicles
  double seconds = 0.0;                   ///< simulated

  void add(const DatasetStatistics& other);
};

/// As JSON text and back; throws InputError naming the file.
std::string toJson(const DatasetStatistics& statistics);
DatasetStatistics readStatistics(const std::filesystem::path& file);

/// Of several sessions or bags, by name.
using StatisticsByName = std::map<std::string, DatasetStatistics>;
DatasetStatistics sumOf(const StatisticsByName& statistics);

// What a data set holds, in words and pictures.

/// Writes statistics.json and, where there are shards, samples.html into the data set's folder, and
/// the statistics as a table to the output.
void describeDataset(const std::filesystem::path& folder, const DatasetStatistics& statistics);

/// Prints to standard error each "session" or "bag" (`kind`) that yielded no sample, with what
/// became of its images and, where they lie too near its end, the `remedy` ("longer bags"). Throws
/// InputError when none gave any.
void requireSamples(const StatisticsByName& statistics, const std::string& kind,
                    const std::string& remedy);

}  // namespace cdiff::collection
