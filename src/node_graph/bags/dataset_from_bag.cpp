// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/dataset_from_bag.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>
#include <set>

#include "collection/collection_loop.h"
#include "collection/collection_options.h"
#include "collection/drive_samples.h"
#include "collection/scene_recorder.h"
#include "collection/session_samples.h"
#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "learning/samples/driving_sample.h"
#include "learning/samples/scene_file.h"
#include "node_graph/bags/driving_bag.h"
#include "node_graph/bags/recorded_session.h"
#include "node_graph/bags/session_bag_writer.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"
#include "sensor_msgs/Image.h"

namespace cdiff::node_graph {
namespace {

using collection::DriveKey;
using core::InputError;

traffic::CameraImage imageOfSession(const sensor_msgs::Image& message, std::uint64_t tick) {
  const std::size_t size = std::size_t{3} * message.width * message.height;
  if (message.encoding != "rgb8" || message.step != 3 * message.width ||
      message.data.size() != size) {
    throw InputError("an image of tick " + std::to_string(tick) + " is '" + message.encoding +
                     "' with " + std::to_string(message.data.size()) +
                     " bytes; expected rgb8 with " + std::to_string(size));
  }
  traffic::CameraImage image;
  image.width = static_cast<int>(message.width);
  image.height = static_cast<int>(message.height);
  image.tick = tick;
  image.rgb = message.data;
  return image;
}

class SessionReader {
 public:
  explicit SessionReader(const std::filesystem::path& file)
      : recording_(file, RecordedImages::kAll) {}

  collection::DrivenSession read() {
    const session::ScenarioOptions& options = recording_.setup().options();
    session_.name = options.name + "_seed" + std::to_string(options.seed);
    while (const auto snapshot = recording_.next()) take(*snapshot);
    if (!recording_.findings().empty())
      throw InputError(core::joinText(recording_.findings(), "; "));
    session_.setup = recording_.takeSetup();
    finish();
    return std::move(session_);
  }

 private:
  void take(const msgs::TrafficSnapshot& snapshot) {
    takeTraffic(snapshot);
    const TickAnswers& answers = recording_.answers();
    if (const auto selection = answers.selection(snapshot.tick)) takeSelection(*selection);
    for (int slot = kEgoSlot; slot < recording_.graph().max_cbv; ++slot) {
      if (const auto control = answers.control(slot, snapshot.tick)) takeControl(*control);
      if (const auto image = answers.image(slot, snapshot.tick))
        session_.images.push_back({slot, imageOfSession(*image, snapshot.tick)});
    }
  }

  void takeTraffic(const msgs::TrafficSnapshot& message) {
    traffic::TrafficSnapshot snapshot = fromMsg(message);
    for (const traffic::Contact& contact : snapshot.contacts) {
      session_.contacts[contact.first].push_back(snapshot.tick);
      session_.contacts[contact.second].push_back(snapshot.tick);
    }
    session_.seconds = std::max(session_.seconds, snapshot.time);
    if (snapshot.decision_tick) session_.decisions.push_back(std::move(snapshot));
  }

  void takeSelection(const msgs::CbvSelection& message) {
    for (const msgs::CbvAssignment& assignment : message.assignments) {
      const DriveKey key{assignment.vehicle_id, assignment.selected_tick};
      session_.drives[message.tick][assignment.slot] = key;
      if (session_.routes.count(key) != 0) continue;
      msgs::CbvSelection one;
      one.assignments.push_back(assignment);
      session_.routes[key] =
          fromMsg(one, recording_.setup().network()).assignments.front().conflict_aware_route;
    }
  }

  void takeControl(const msgs::ControlAction& message) {
    const std::string mark = kNoiseMark;
    const std::string& planner = message.planner;
    const bool noisy = planner.size() >= mark.size() &&
                       planner.compare(planner.size() - mark.size(), mark.size(), mark) == 0;
    if (noisy || !message.fault.empty())
      session_.disturbed.insert({message.vehicle_id, message.tick});
  }

  void finish() {
    const session::ScenarioOptions& options = session_.setup->options();
    if (std::abs(options.decision_period - kDecisionPeriod) > 1e-9) {
      throw InputError("its decisions are " + core::formatNumber(options.decision_period) +
                       " s apart; samples need 0.1 s");
    }
    if (session_.images.empty()) throw InputError("it holds no camera images");
    const DriveKey ego{traffic::kEgoId, 0};
    session_.routes[ego] = session_.setup->egoRoute();
    for (const traffic::TrafficSnapshot& snapshot : session_.decisions)
      session_.drives[snapshot.tick][traffic::kEgoSlot] = ego;
  }

  static constexpr double kDecisionPeriod = 0.1;  ///< of a rollout [s]
  RecordedSession recording_;
  collection::DrivenSession session_;
};

}  // namespace

collection::DrivenSession readSessionBag(const std::filesystem::path& file) {
  SessionReader reader(file);
  try {
    return reader.read();
  } catch (const std::exception& error) {
    throw InputError("bag '" + file.string() + "': " + error.what());
  }
}

std::vector<learning::DrivingSample> samplesFromBag(const std::filesystem::path& bag,
                                                    const collection::DatasetOptions& options,
                                                    collection::DatasetStatistics& statistics) {
  const collection::DrivenSession session = readSessionBag(bag);
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

namespace {

namespace fs = std::filesystem;

void runToItsEnd(collection::CollectionLoop& loop, const std::atomic<bool>& stop) {
  const traffic::SessionStatus status = loop.run(stop);
  if (status == traffic::SessionStatus::kInterrupted) throw core::Interrupted("interrupted");
  if (status == traffic::SessionStatus::kError)
    throw core::SimulatorError(loop.world().snapshot().faults.back().text);
}

/// Drives the session, and writes its bag where shards are made of it or it is asked for, and its
/// scene where that is asked for.
void record(const collection::CollectRequest& request, const collection::CollectSettings& settings,
            const std::string& name, const std::atomic<bool>& stop) {
  const auto setup = collection::collectionSetup(settings.scenario, settings.collection);
  collection::CollectionLoop loop(*setup, settings.collection, request.images);
  std::optional<SessionBagWriter> bag;
  std::optional<collection::SceneRecorder> scene;
  if (request.images || request.keep_bag || !request.scenes) {
    bag.emplace(*setup, collection::bagFile(request, name),
                BagOrigin{"cdiff collect", loop.world().simulatorVersion()});
    bag->setNoiseQuery([&](const std::string& id) { return loop.perturbed(id); });
    loop.addObserver(*bag);
  }
  if (request.scenes) loop.addObserver(scene.emplace(*setup, collection::driverQueries(loop)));
  runToItsEnd(loop, stop);
  if (bag) bag->finish();
  if (!scene) return;
  const fs::path file = collection::sceneFile(request, name);
  learning::writeScene(file, scene->take());
}

collection::DatasetStatistics writeShard(const collection::CollectRequest& request,
                                         const collection::CollectSettings& settings,
                                         const fs::path& bag, const fs::path& shard) {
  collection::DatasetOptions options = collection::datasetOptions(settings.collection);
  const auto seed = static_cast<std::uint64_t>(settings.scenario.seed);
  options.target_speed = [&](const std::string& id) {
    return collection::driverOf(settings.collection, seed, id).target_speed;
  };
  collection::DatasetStatistics statistics;
  learning::DrivingShardWriter writer(collection::schemaOf(options.architecture));
  for (const learning::DrivingSample& sample : samplesFromBag(bag, options, statistics))
    writer.append(sample);
  if (statistics.samples == 0) {
    core::OutputFolder(shard.parent_path()).remove({shard.filename().string()});
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
  core::loadOptions({file, core::readFile(file, "topics", core::kLargestOptionsFile)}, topics);
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
  record(request, settings, name, stop);
  if (!request.images) return;
  const collection::DatasetStatistics statistics =
      writeShard(request, settings, bag, collection::shardFile(request, name));
  if (!request.keep_bag) core::OutputFolder(bag.parent_path()).remove({bag.filename().string()});
  const fs::path file = collection::statisticsFile(request, name);
  core::writeOwnFile(file, collection::toJson(statistics));
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
    writer.write(shard, {{"made_by", "cdiff collect --bags"},
                         {"bag", bag.filename().string()},
                         {"topics", core::dumpOptions(topics)}});
  }
  return all;
}

}  // namespace cdiff::node_graph
