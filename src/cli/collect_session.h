// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// One session of data collection in this process: bag, shard, statistics.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "collection/collection_options.h"
#include "ros/dataset_from_bag.h"
#include "session/scenario_options.h"

namespace cdiff::cli {

/// What `cdiff collect` asks of one of its processes.
struct CollectRequest {
  std::string scenario;  ///< shipped name or file
  std::int64_t seed = 1;
  std::filesystem::path results;
  double duration = 60.0;  ///< [s]
  bool keep_bag = false;
  bool images = true;            ///< without: the bag alone
  std::vector<std::string> set;  ///< key=value each
};

/// Options of a session, collection's own in the group "collection".
struct CollectSettings {
  session::ScenarioOptions scenario;
  collection::CollectionOptions collection;

  void describe(core::OptionsVisitor& visitor);
};

/// Throws InputError for an unknown scenario, key or value.
CollectSettings resolveCollection(const CollectRequest& request);
/// "SCENARIO_seedN": the name of its files.
std::string sessionName(const CollectSettings& settings);
std::filesystem::path shardFile(const CollectRequest& request, const std::string& name);
std::filesystem::path statisticsFile(const CollectRequest& request, const std::string& name);

/// Runs the session and writes its files; answers the exit code.
int collectSession(const CollectRequest& request);

/// As JSON text and back; throws InputError naming the file.
std::string toJson(const ros::DatasetStatistics& statistics);
ros::DatasetStatistics readStatistics(const std::filesystem::path& file);

}  // namespace cdiff::cli
