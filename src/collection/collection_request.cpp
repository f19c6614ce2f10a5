// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/collection_request.h"

#include <algorithm>
#include <cmath>

#include "collection/random_route.h"
#include "core/text.h"
#include "e2e_cdiff/core/random.h"
#include "planners/registry.h"

namespace cdiff::collection {
namespace {

// Elements of a session's draws.
constexpr std::uint32_t kLights = 0;
constexpr std::uint32_t kDensity = 1;

constexpr double kEgoBlockedTime = 60.0;    // [s]
constexpr double kEgoDeviation = 100.0;     // [m]
constexpr double kCollectionWarmUp = 20.0;  // [s]

}  // namespace

session::ScenarioOptions collectionScenario(session::ScenarioOptions scenario,
                                            const CollectionOptions& options) {
  options.validate();
  const core::RandomStream random(static_cast<std::uint64_t>(scenario.seed), "collection_session");
  const core::RandomKey key{core::hashText(scenario.name), 0, 0};
  scenario.max_cbv = options.vehicles;
  const std::string expert = planners::kDefaultEgoPlanner;
  for (std::string* planner : {&scenario.ego_planner, &scenario.cbv_planner}) {
    if (planners::seesImages(*planner)) *planner = expert;
  }
  scenario.protocol.time_limit = options.duration;
  scenario.protocol.time_limit_speed_percent = 0.0;
  scenario.protocol.blocked_time = kEgoBlockedTime;
  scenario.protocol.deviation_distance = kEgoDeviation;
  scenario.protocol.deviation_percent = 100.0;
  const bool own_lights = random.uniform(key, kLights) < options.program_lights_share;
  scenario.lights = own_lights ? "program" : "green";
  const bool file = scenario.demand != "generated" && scenario.demand != "none";
  if (file && scenario.seed % 2 != 0) scenario.demand = "generated";
  const double density =
      random.uniform(key, kDensity, options.minimum_density, options.maximum_density);
  scenario.traffic.density = std::llround(density);
  scenario.traffic.warm_up = std::min(scenario.traffic.warm_up, kCollectionWarmUp);
  return scenario;
}

std::unique_ptr<session::SessionSetup> collectionSetup(const session::ScenarioOptions& scenario,
                                                       const CollectionOptions& options) {
  auto setup = std::make_unique<session::SessionSetup>(scenario);
  const core::RandomStream random(static_cast<std::uint64_t>(scenario.seed), "collection_ego");
  const double length = options.duration * options.maximum_speed;
  const map::Route longer = extendedAtRandom(setup->graph(), setup->egoRoute(), length, random);
  if (longer.length() <= setup->egoRoute().length()) return setup;
  return std::make_unique<session::SessionSetup>(scenario, setup->import(), longer.path().points());
}

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
