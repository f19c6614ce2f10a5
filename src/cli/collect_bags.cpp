// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/collect_bags.h"

#include <iostream>
#include <set>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/driving_sample.h"
#include "ros/dataset_from_driving_bag.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using core::InputError;

ros::DrivingBagOptions loadTopics(const std::string& file) {
  if (file.empty()) {
    throw InputError("--bags needs --topics FILE, a YAML file such as\n" +
                     core::dumpOptions(ros::DrivingBagOptions{}, true));
  }
  ros::DrivingBagOptions topics;
  core::loadOptions({file, core::readFile(file, "topics")}, topics);
  topics.validate();
  return topics;
}

void requireDistinctNames(const std::vector<std::string>& bags) {
  std::set<std::string> names;
  for (const fs::path bag : bags) {
    if (!names.insert(bag.stem().string()).second)
      throw InputError("two bags are called '" + bag.stem().string() +
                       "'; each gives a shard of its name: rename one");
  }
}

}  // namespace

std::map<std::string, ros::DatasetStatistics> collectBags(const BagRequest& request) {
  const ros::DrivingBagOptions topics = loadTopics(request.topics);
  requireDistinctNames(request.bags);
  const ros::DatasetOptions options;
  std::map<std::string, ros::DatasetStatistics> all;
  for (const fs::path bag : request.bags) {
    ros::DatasetStatistics& statistics = all[bag.stem().string()];
    learning::DrivingShardWriter writer(ros::schemaOf(options.architecture));
    for (const learning::DrivingSample& sample :
         ros::samplesFromDrivingBag(bag, topics, options, statistics))
      writer.append(sample);
    const fs::path shard = request.results / "shards" / (bag.stem().string() + ".shard");
    fs::create_directories(shard.parent_path());
    writer.write(shard, {{"made_by", "cdiff collect --bags"},
                         {"bag", bag.filename().string()},
                         {"topics", core::dumpOptions(topics)}});
    std::cerr << bag.string() << ": " << statistics.samples << " samples\n";
  }
  return all;
}

}  // namespace cdiff::cli
