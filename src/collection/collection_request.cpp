// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/collection_request.h"

#include "collection/collection_scenario.h"
#include "core/text.h"

namespace cdiff::collection {
namespace {

namespace fs = std::filesystem;

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
  settings.scenario = collectionScenario(settings.scenario, settings.collection);
  override(settings, request.set);
  settings.scenario.validate();
  settings.collection.validate();
  return settings;
}

std::string sessionName(const CollectSettings& settings) {
  return core::fileName(settings.scenario.name) + "_seed" + std::to_string(settings.scenario.seed);
}

fs::path bagFile(const CollectRequest& request, const std::string& name) {
  return request.results / "bags" / (name + ".bag");
}

fs::path shardFile(const CollectRequest& request, const std::string& name) {
  return request.results / "shards" / (name + ".shard");
}

fs::path statisticsFile(const CollectRequest& request, const std::string& name) {
  return request.results / "sessions" / (name + ".json");
}

}  // namespace cdiff::collection
