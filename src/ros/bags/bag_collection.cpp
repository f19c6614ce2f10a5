// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/bags/bag_collection.h"

#include <iostream>
#include <set>

#include "collection/collection_loop.h"
#include "collection/collection_options.h"
#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/driving_sample.h"
#include "ros/bags/dataset_from_bag.h"
#include "ros/bags/session_bag_writer.h"

namespace cdiff::ros {
namespace {

namespace fs = std::filesystem;
using core::InputError;

void record(const collection::CollectRequest& request, const collection::CollectSettings& settings,
            const fs::path& file, const std::atomic<bool>& stop) {
  const auto setup = collection::collectionSetup(settings.scenario, settings.collection);
  collection::CollectionLoop loop(*setup, settings.collection, request.images);
  SessionBagWriter bag(*setup, file, {"cdiff collect", loop.world().simulatorVersion()});
  bag.setNoiseQuery([&](const std::string& id) { return loop.perturbed(id); });
  loop.addObserver(bag);
  const traffic::SessionStatus status = loop.run(stop);
  if (status == traffic::SessionStatus::kInterrupted) throw core::Interrupted("interrupted");
  if (status == traffic::SessionStatus::kError)
    throw core::SimulatorError(loop.world().snapshot().faults.back().text);
  bag.finish();
}

collection::DatasetStatistics writeShard(const collection::CollectRequest& request,
                                         const collection::CollectSettings& settings,
                                         const fs::path& bag, const fs::path& shard) {
  const collection::DatasetOptions options = collection::datasetOptions(settings.collection);
  collection::DatasetStatistics statistics;
  learning::DrivingShardWriter writer(collection::schemaOf(options.architecture));
  for (const learning::DrivingSample& sample : samplesFromBag(bag, options, statistics))
    writer.append(sample);
  fs::create_directories(shard.parent_path());
  if (statistics.samples == 0) {
    fs::remove(shard);
    return statistics;
  }
  writer.write(shard, {{"made_by", "cdiff collect"},
                       {"scenario", settings.scenario.name},
                       {"seed", std::to_string(request.seed)},
                       {"planner", settings.scenario.cbv_planner},
                       {"collection", core::dumpOptions(settings.collection)}});
  return statistics;
}

collection::DriveOptions loadTopics(const std::string& file) {
  if (file.empty()) {
    throw InputError("--bags needs --topics FILE, a YAML file such as\n" +
                     core::dumpOptions(collection::DriveOptions{}, true));
  }
  collection::DriveOptions topics;
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

void collectSession(const collection::CollectRequest& request, const std::atomic<bool>& stop) {
  const collection::CollectSettings settings = collection::resolveCollection(request);
  const std::string name = collection::sessionName(settings);
  const fs::path bag = collection::bagFile(request, name);
  record(request, settings, bag, stop);
  if (!request.images) return;
  const collection::DatasetStatistics statistics =
      writeShard(request, settings, bag, collection::shardFile(request, name));
  if (!request.keep_bag) fs::remove(bag);
  const fs::path file = collection::statisticsFile(request, name);
  fs::create_directories(file.parent_path());
  core::writeFileAtomically(file, collection::toJson(statistics));
}

collection::StatisticsByName collectBags(const BagRequest& request) {
  const collection::DriveOptions topics = loadTopics(request.topics);
  requireDistinctNames(request.bags);
  const collection::DatasetOptions options;
  collection::StatisticsByName all;
  for (const fs::path bag : request.bags) {
    collection::DatasetStatistics& statistics = all[bag.stem().string()];
    learning::DrivingShardWriter writer(collection::schemaOf(options.architecture));
    for (const learning::DrivingSample& sample :
         samplesFromDrivingBag(bag, topics, options, statistics))
      writer.append(sample);
    const fs::path shard = request.results / "shards" / (bag.stem().string() + ".shard");
    std::cerr << bag.string() << ": " << statistics.samples << " samples\n";
    if (statistics.samples == 0) continue;
    fs::create_directories(shard.parent_path());
    writer.write(shard, {{"made_by", "cdiff collect --bags"},
                         {"bag", bag.filename().string()},
                         {"topics", core::dumpOptions(topics)}});
  }
  return all;
}

}  // namespace cdiff::ros
