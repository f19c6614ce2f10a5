// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/collect_session.h"

#include <atomic>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "collection/collection_loop.h"
#include "collection/collection_scenario.h"
#include "core/file.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "ros/session_bag.h"
#include "training/shard.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void record(const CollectRequest& request, const CollectSettings& settings, const fs::path& file,
            const std::atomic<bool>& stop) {
  const auto setup = collection::collectionSetup(settings.scenario, settings.collection);
  collection::CollectionLoop loop(*setup, settings.collection, request.images);
  ros::SessionBag bag(*setup, file, {"cdiff collect", loop.world().simulatorVersion()});
  bag.setNoiseQuery([&](const std::string& id) { return loop.perturbed(id); });
  loop.addObserver(bag);
  const traffic::SessionStatus status = loop.run(stop);
  if (status == traffic::SessionStatus::kInterrupted) throw core::Interrupted("interrupted");
  if (status == traffic::SessionStatus::kError)
    throw core::SimulatorError(loop.world().snapshot().faults.back().text);
  bag.finish();
}

ros::DatasetStatistics writeShard(const CollectRequest& request, const CollectSettings& settings,
                                  const fs::path& bag, const fs::path& shard) {
  ros::DatasetOptions options;
  options.standing_share = settings.collection.standing_share;
  options.offset_share = settings.collection.offset_share;
  options.offset_lateral = settings.collection.offset_lateral;
  options.offset_heading = settings.collection.offset_heading;
  ros::DatasetStatistics statistics;
  training::ShardWriter writer(ros::schemaOf(options.architecture));
  for (const training::Sample& sample : ros::samplesFromBag(bag, options, statistics))
    writer.append(sample);
  fs::create_directories(shard.parent_path());
  // A session without samples leaves no shard, and is driven again when it is asked for again.
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

void override(CollectSettings& settings, const std::vector<std::string>& set) {
  for (const std::string& assignment : set) core::overrideOption(assignment, "--set", settings);
}

}  // namespace

void CollectSettings::describe(core::OptionsVisitor& visitor) {
  scenario.describe(visitor);
  visitor.group({"collection", "", "Data collection."}, collection);
}

CollectSettings resolveCollection(const CollectRequest& request) {
  CollectSettings settings;
  settings.scenario = session::loadScenario(request.scenario);
  settings.scenario.seed = request.seed;
  settings.collection.duration = request.duration;
  override(settings, request.set);
  settings.scenario = collection::collectionScenario(settings.scenario, settings.collection);
  override(settings, request.set);
  settings.scenario.validate();
  settings.collection.validate();
  return settings;
}

std::string sessionName(const CollectSettings& settings) {
  return core::fileName(settings.scenario.name) + "_seed" + std::to_string(settings.scenario.seed);
}

fs::path shardFile(const CollectRequest& request, const std::string& name) {
  return request.results / "shards" / (name + ".shard");
}

fs::path statisticsFile(const CollectRequest& request, const std::string& name) {
  return request.results / "sessions" / (name + ".json");
}

int collectSession(const CollectRequest& request) {
  const std::atomic<bool>& stop = core::catchStopSignals();
  const CollectSettings settings = resolveCollection(request);
  const std::string name = sessionName(settings);
  const fs::path bag = request.results / "bags" / (name + ".bag");
  record(request, settings, bag, stop);
  if (!request.images) return kPassed;
  const ros::DatasetStatistics statistics =
      writeShard(request, settings, bag, shardFile(request, name));
  if (!request.keep_bag) fs::remove(bag);
  const fs::path file = statisticsFile(request, name);
  fs::create_directories(file.parent_path());
  core::writeFileAtomically(file, toJson(statistics));
  return kPassed;
}

std::string toJson(const ros::DatasetStatistics& statistics) {
  json text = {{"images", statistics.images},
               {"samples", statistics.samples},
               {"dropped", statistics.dropped},
               {"maneuvers", statistics.maneuvers},
               {"stop_reasons", statistics.stop_reasons},
               {"kinds", statistics.kinds},
               {"speeds_2_mps", statistics.speeds},
               {"steer_sum", statistics.steer_sum},
               {"contacts", statistics.contacts},
               {"seconds", statistics.seconds}};
  const auto samples = static_cast<double>(statistics.samples);
  if (statistics.samples > 0) text["mean_absolute_steer"] = statistics.steer_sum / samples;
  return text.dump(2) + "\n";
}

ros::DatasetStatistics readStatistics(const fs::path& file) {
  try {
    const json text = json::parse(core::readFile(file, "statistics"));
    ros::DatasetStatistics statistics;
    text.at("images").get_to(statistics.images);
    text.at("samples").get_to(statistics.samples);
    text.at("dropped").get_to(statistics.dropped);
    text.at("maneuvers").get_to(statistics.maneuvers);
    text.at("stop_reasons").get_to(statistics.stop_reasons);
    text.at("kinds").get_to(statistics.kinds);
    text.at("speeds_2_mps").get_to(statistics.speeds);
    text.at("steer_sum").get_to(statistics.steer_sum);
    text.at("contacts").get_to(statistics.contacts);
    text.at("seconds").get_to(statistics.seconds);
    return statistics;
  } catch (const json::exception& error) {
    throw core::InputError("statistics '" + file.string() + "': " + error.what());
  }
}

}  // namespace cdiff::cli
