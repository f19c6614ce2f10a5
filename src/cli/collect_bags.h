// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// `cdiff collect --bags`: training samples from bags that others recorded.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "ros/dataset_from_bag.h"

namespace cdiff::cli {

struct BagRequest {
  std::vector<std::string> bags;
  std::string topics;             ///< YAML file: ros::DrivingBagOptions
  std::filesystem::path results;  ///< folder of the data set
};

/// Writes shards/NAME.shard for each bag and returns what is in each, by NAME. Throws InputError,
/// also for two bags of one name; shards written before stay.
std::map<std::string, ros::DatasetStatistics> collectBags(const BagRequest& request);

}  // namespace cdiff::cli
