// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/collection_options.h"

#include <algorithm>
#include <cmath>

#include "collection/camera_sight.h"
#include "collection/driver.h"
#include "collection/traffic_driver.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "learning/samples/scene_file.h"
#include "planners/pdm_lite/pdm_lite_options.h"
#include "planners/registry.h"
#include "session/demand_file.h"

namespace cdiff::collection {
namespace {

namespace fs = std::filesystem;

void requireOrder(const char* low_key, double low, const char* high_key, double high) {
  if (low <= high) return;
  throw core::InputError(std::string("collection: ") + low_key + " is " + core::formatNumber(low) +
                         ", more than " + high_key + " (" + core::formatNumber(high) + ")");
}

// Elements of a session's draws: its lights and its traffic density.
constexpr std::uint32_t kLights = 0;
constexpr std::uint32_t kDensity = 1;

// Protocol of collection: it ends a session early only when the ego is stuck or has left its route.
constexpr double kEgoBlockedTime = 60.0;    // [s]
constexpr double kEgoDeviation = 100.0;     // [m]
constexpr double kCollectionWarmUp = 20.0;  // [s] of traffic before the first tick, at most

/// Applies the key=value assignments of --set.
void override(CollectSettings& settings, const std::vector<std::string>& set) {
  for (const std::string& assignment : set) core::overrideOption(assignment, "--set", settings);
}

}  // namespace

void NoiseOptions::describe(core::OptionsVisitor& visitor) {
  visitor.number({"interval", "s", "Mean time between bursts of noise."}, interval, 0.5, 1e6);
  visitor.number({"minimum_time", "s", "Shortest burst."}, minimum_time, 0.1, 10.0);
  visitor.number({"maximum_time", "s", "Longest burst."}, maximum_time, 0.1, 10.0);
  visitor.number({"steer", "", "Largest addition to the steering."}, steer, 0.0, 1.0);
  visitor.number({"steer_speed", "m/s", "Speed above which the addition shrinks."}, steer_speed,
                 0.1, 40.0);
  visitor.number({"pedal", "", "Largest addition to throttle or brake."}, pedal, 0.0, 1.0);
  visitor.number({"stall_share", "", "Part of the bursts that stop the vehicle."}, stall_share, 0.0,
                 1.0);
  visitor.number({"stall_minimum_time", "s", "Shortest stop, braking included."},
                 stall_minimum_time, 0.1, 60.0);
  visitor.number({"stall_maximum_time", "s", "Longest stop, at most standing_time."},
                 stall_maximum_time, 0.1, 60.0);
  visitor.number({"lateral", "m", "Standard deviation of the place at the take-over."}, lateral,
                 0.0, 2.0);
  visitor.number({"heading", "deg", "Standard deviation of the heading at the take-over."}, heading,
                 0.0, 30.0);
}

// NOLINTNEXTLINE(readability-function-size): a table
void CollectionOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"vehicles", "", "Background vehicles driven at a time."}, vehicles, 0, 16);
  visitor.number({"duration", "s", "Longest session."}, duration, 1.0, 3600.0);
  visitor.number({"image_period", "s", "Time between images of a vehicle."}, image_period, 0.1,
                 10.0);
  visitor.number({"minimum_speed", "m/s", "Lowest target speed."}, minimum_speed, 0.5, 40.0);
  visitor.number({"maximum_speed", "m/s", "Highest target speed."}, maximum_speed, 0.5, 40.0);
  visitor.number({"maximum_gap", "m", "Largest gap kept behind a standing leader."}, maximum_gap,
                 4.0, 50.0);
  visitor.number({"maximum_headway", "s", "Largest time kept to a leader."}, maximum_headway, 0.25,
                 10.0);
  visitor.text({"pedals", "", "Even pedals, or PDM-Lite's as published: full or none."}, pedals,
               {"even", "published"});
  visitor.number({"minimum_acceleration", "m/s^2", "Least acceleration of an even vehicle."},
                 minimum_acceleration, 0.5, 8.0);
  visitor.number({"maximum_acceleration", "m/s^2", "Largest acceleration of an even vehicle."},
                 maximum_acceleration, 0.5, 8.0);
  visitor.number({"minimum_deceleration", "m/s^2", "Least comfortable deceleration."},
                 minimum_deceleration, 0.5, 8.0);
  visitor.number({"maximum_deceleration", "m/s^2", "Largest comfortable deceleration."},
                 maximum_deceleration, 0.5, 8.0);
  visitor.number({"radius", "m", "Vehicles this near the ego are driven."}, radius, 10.0, 1000.0);
  visitor.number({"spacing", "m", "Wished between driven vehicles when chosen."}, spacing, 0.0,
                 100.0);
  visitor.number({"minimum_route", "m", "Shorter routes are not taken."}, minimum_route, 20.0,
                 2000.0);
  visitor.number({"route_length", "m", "Length of routes where the network allows."}, route_length,
                 20.0, 2000.0);
  visitor.number({"route_end", "m", "Released with less of the route left."}, route_end, 5.0,
                 500.0);
  visitor.number({"off_road_distance", "m", "Released farther outside the drivable area."},
                 off_road_distance, 0.0, 50.0);
  visitor.number({"standing_time", "s", "Released after standing so long."}, standing_time, 1.0,
                 1000.0);
  visitor.number({"pause", "s", "Before a released vehicle may be driven again."}, pause, 0.0,
                 1000.0);
  visitor.number({"lane_change_share", "", "Share of long lanes on which a route changes lane."},
                 lane_change_share, 0.0, 1.0);
  visitor.number({"program_lights_share", "", "Share of sessions with the lights' programs."},
                 program_lights_share, 0.0, 1.0);
  visitor.number({"minimum_density", "", "Fewest vehicles of generated demand."}, minimum_density,
                 0.0, 500.0);
  visitor.number({"maximum_density", "", "Most vehicles of generated demand."}, maximum_density,
                 0.0, 500.0);
  visitor.number({"standing_share", "", "Part kept of samples that stand all the time."},
                 standing_share, 0.0, 1.0);
  visitor.number({"offset_share", "", "Part of moving samples that are displaced once more."},
                 offset_share, 0.0, 1.0);
  visitor.number({"offset_lateral", "m", "Largest displacement to the side."}, offset_lateral, 0.0,
                 3.0);
  visitor.number({"offset_heading", "deg", "Largest turn of a displaced vehicle."}, offset_heading,
                 0.0, 45.0);
  visitor.text({"sight", "", "Others that the expert knows of: all, or those its camera shows."},
               sight, {"all", "camera"});
  visitor.text({"policy", "", "Planner that drives CBVs now and then; empty: none."}, policy, {});
  visitor.number({"policy_period", "s", "From one such time of a vehicle to the next."},
                 policy_period, 1.0, 100.0);
  visitor.number({"policy_time", "s", "Longest time that it drives."}, policy_time, 0.1, 100.0);
  visitor.number({"policy_share", "", "Share of the periods in which it does."}, policy_share, 0.0,
                 1.0);
  visitor.integer({"policy_plans", "",
                   "Plans of diffusion.model drawn for each moving sample, of which one, drawn by "
                   "its return, makes another sample; 0: none."},
                  policy_plans, 0, 64);
  visitor.group({"noise", "", "Disturbances."}, noise);
}

void CollectionOptions::validate() const {
  requireOrder("minimum_speed", minimum_speed, "maximum_speed", maximum_speed);
  requireOrder("minimum_acceleration", minimum_acceleration, "maximum_acceleration",
               maximum_acceleration);
  requireOrder("minimum_deceleration", minimum_deceleration, "maximum_deceleration",
               maximum_deceleration);
  requireOrder("minimum_density", minimum_density, "maximum_density", maximum_density);
  requireOrder("minimum_route", minimum_route, "route_length", route_length);
  requireOrder("route_end", route_end, "minimum_route", minimum_route);
  if (policy_plans == 1)
    throw core::InputError("collection: policy_plans is 1; a choice needs 2 or more, 0 makes none");
  requireOrder("policy_time", policy_time, "policy_period", policy_period);
  requireOrder("noise.stall_minimum_time", noise.stall_minimum_time, "noise.stall_maximum_time",
               noise.stall_maximum_time);
  if (noise.stall_share > 0.0)
    requireOrder("noise.stall_maximum_time", noise.stall_maximum_time, "standing_time",
                 standing_time);
  requireOrder("noise.minimum_time", noise.minimum_time, "noise.maximum_time", noise.maximum_time);
}

DatasetOptions datasetOptions(const CollectionOptions& options) {
  DatasetOptions dataset;
  dataset.standing_share = options.standing_share;
  dataset.offset_share = options.offset_share;
  dataset.offset_lateral = options.offset_lateral;
  dataset.offset_heading = options.offset_heading;
  dataset.policy_plans = options.policy_plans;
  return dataset;
}

learning::DrivingSchema schemaOf(const diffusion::Architecture& architecture) {
  learning::DrivingSchema schema;
  schema.horizon = architecture.horizon;
  schema.image_width = architecture.image_width;
  schema.image_height = architecture.image_height;
  schema.route_points = architecture.route_points;
  schema.route_spacing = architecture.route_spacing;
  schema.auxiliary = sightTargets();
  schema.previous_interval = kPreviousInterval;
  schema.target_speeds = true;
  return schema;
}

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
  const bool from_file = session::hasDemandFile(scenario);
  if (from_file && scenario.seed % 2 != 0) scenario.demand = "generated";
  const double density =
      random.uniform(key, kDensity, options.minimum_density, options.maximum_density);
  scenario.traffic.density = std::llround(density);
  scenario.traffic.warm_up = std::min(scenario.traffic.warm_up, kCollectionWarmUp);
  return scenario;
}

std::unique_ptr<session::SessionSetup> collectionSetup(const session::ScenarioOptions& scenario,
                                                       const CollectionOptions& options) {
  session::ScenarioOptions driven = scenario;
  driven.planner_options.of<planners::PdmLiteOptions>().styles =
      [options, seed = static_cast<std::uint64_t>(scenario.seed)](const std::string& id) {
        return driverOf(options, seed, id).style;
      };
  auto setup = std::make_unique<session::SessionSetup>(driven);
  const core::RandomStream random(static_cast<std::uint64_t>(scenario.seed), "collection_ego");
  const double length = options.duration * options.maximum_speed;
  const map::Route longer = extendedAtRandom(setup->graph(), setup->egoRoute(), length, random);
  if (longer.length() <= setup->egoRoute().length()) return setup;
  return std::make_unique<session::SessionSetup>(driven, setup->import(), longer.path().points());
}

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
  if (!settings.scenario.route.bench2drive_file.empty()) {
    throw core::InputError("scenario '" + request.scenario +
                           "': key 'route.bench2drive_file' is set; routes of Bench2Drive are for "
                           "evaluation, and no training data may come from them");
  }
  settings.scenario.validate();
  settings.collection.validate();
  if ((request.images || request.scenes) &&
      std::abs(settings.scenario.decision_period - traffic::kRolloutStep) > 1e-9) {
    throw core::InputError("key 'decision_period' is " +
                           core::formatNumber(settings.scenario.decision_period) +
                           " s; samples and scenes need 0.1 s");
  }
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

fs::path sceneFile(const CollectRequest& request, const std::string& name) {
  return request.results / "scenes" / (name + learning::kSceneExtension);
}

fs::path statisticsFile(const CollectRequest& request, const std::string& name) {
  return request.results / "sessions" / (name + ".json");
}

}  // namespace cdiff::collection
