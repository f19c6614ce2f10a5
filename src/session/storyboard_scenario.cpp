// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/storyboard_scenario.h"

#include <filesystem>
#include <map>
#include <set>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/planner_by_slot.h"
#include "planners/registry.h"
#include "simulation/demand_generator.h"
#include "storyboard/scenario_reader.h"

namespace cdiff::session {
namespace {

using core::InputError;
using storyboard::Entity;
using storyboard::Scenario;

const Entity& egoOf(const Scenario& scenario) {
  const Entity* external = nullptr;
  for (const Entity& entity : scenario.entities) {
    if (core::lowerCase(entity.controller).find("external") == std::string::npos) continue;
    if (external != nullptr) {
      throw InputError(entity.source.text() + ": '" + external->name + "' and '" + entity.name +
                       "' have external controllers; expected one ego");
    }
    external = &entity;
  }
  if (external != nullptr) return *external;
  for (const Entity& entity : scenario.entities) {
    const std::string name = core::lowerCase(entity.name);
    if (name == "ego" || name == "hero") return entity;
  }
  throw InputError(scenario.entities.front().source.text() +
                   ": no entity is the ego; expected one with a controller 'external_control', or "
                   "one named Ego or hero");
}

/// Names of entities are ids of vehicles: those of SUMO, and "ego" is taken.
void requireUsableNames(const Scenario& scenario, const Entity& ego) {
  for (const Entity& entity : scenario.entities) {
    if (&entity == &ego) continue;
    if (entity.name != core::fileName(entity.name) || entity.name == traffic::kEgoId ||
        entity.name.rfind(simulation::kGeneratedPrefix, 0) == 0) {
      throw InputError(entity.source.text() + ": '" + entity.name +
                       "' cannot be the name of a vehicle; expected letters, digits, '_', '-' and "
                       "'.', not 'ego', and not 'bg_' at the beginning");
    }
  }
}

/// An entity of which the storyboard's beginning wants something must be somewhere.
void requirePlaces(const Scenario& scenario, const Entity& ego) {
  using storyboard::InitAction;
  std::set<std::string> placed = {"", ego.name};
  for (const InitAction& init : scenario.init) {
    if (std::holds_alternative<storyboard::TeleportAction>(init.action.what))
      placed.insert(init.entity);
    if (const auto* added = std::get_if<storyboard::EntityAction>(&init.action.what))
      placed.insert(added->entity);
  }
  for (const InitAction& init : scenario.init) {
    const auto& what = init.action.what;
    const bool needs_none = std::holds_alternative<storyboard::NoAction>(what) ||
                            std::holds_alternative<storyboard::ControllerAction>(what);
    if (needs_none || placed.count(init.entity) != 0) continue;
    throw InputError(init.action.source.text() + ": '" + init.entity +
                     "' has no place in <Init>; expected a <TeleportAction>");
  }
}

/// The planner that a controller's name stands for, in a role; empty where there is none.
std::string plannerOf(const Entity& entity, planners::Role role) {
  const std::string name = core::lowerCase(entity.controller);
  const planning::PlannerDescriptor* const descriptor = planners::findPlanner(name);
  if (descriptor == nullptr) return {};
  try {
    planners::requirePlanner("controller", name, role);
  } catch (const InputError& error) {
    throw InputError(entity.source.text() + ": " + error.what());
  }
  return name;
}

/// The ego's start speed, from <Init> [m/s]; 0 where there is none. Throws InputError for one that
/// our planners do not drive.
double startSpeedOf(const Scenario& scenario, const std::string& ego) {
  constexpr double kMostSpeed = 40.0;  // [m/s], as of the key target_speed
  double speed = 0.0;
  for (const storyboard::InitAction& init : scenario.init) {
    const auto* const action = std::get_if<storyboard::SpeedAction>(&init.action.what);
    if (init.entity != ego || action == nullptr || !action->entity.empty()) continue;
    speed = action->value;
    if (speed >= 0.0 && speed <= kMostSpeed) continue;
    throw InputError(init.action.source.text() + ": the ego starts with " +
                     core::formatNumber(speed) + " m/s; expected 0 to " +
                     core::formatNumber(kMostSpeed) + " m/s");
  }
  return speed;
}

void chooseCbvs(const Scenario& scenario, const Entity& ego, ScenarioOptions& options) {
  std::string chosen;
  options.cbv.only.clear();
  for (const Entity& entity : scenario.entities) {
    const std::string planner = &entity == &ego ? "" : plannerOf(entity, planners::Role::kCbv);
    if (planner.empty()) continue;
    if (entity.kind != Entity::Kind::kVehicle) {
      throw InputError(entity.source.text() + ": '" + entity.name + "' has the controller '" +
                       planner + "'; expected a car or another motor vehicle, which it can drive");
    }
    if (!chosen.empty() && planner != chosen) {
      throw InputError(entity.source.text() + ": the controller is '" + planner + "'; expected '" +
                       chosen + "' as before, because all CBVs have one planner");
    }
    chosen = planner;
    options.cbv.only.push_back(entity.name);
  }
  options.max_cbv = static_cast<std::int64_t>(options.cbv.only.size());
  if (!chosen.empty()) options.cbv_planner = chosen;
}

/// A criterion of scenario_runner, and the rule that it stands for.
struct Criterion {
  const char* name;
  double VerdictOptions::*limit;
  bool given = false;  ///< whether the file gives the limit, else it is 0
};

constexpr Criterion kCriteria[] = {
    {"criteria_collisiontest", &VerdictOptions::maximum_ego_collisions},
    {"criteria_drivendistancetest", &VerdictOptions::minimum_ego_distance, true},
    {"criteria_runningredlighttest", &VerdictOptions::maximum_red_lights},
    {"criteria_runningstoptest", &VerdictOptions::maximum_stop_signs},
    {"criteria_wronglanetest", &VerdictOptions::maximum_outside_lanes_percent},
    {"criteria_onsidewalktest", &VerdictOptions::maximum_outside_lanes_percent},
    {"criteria_keeplanetest", &VerdictOptions::maximum_outside_lanes_percent}};

/// A condition on a parameter is a criterion by its own name, or by that of the parameter.
void addCriterion(const storyboard::Condition& condition, VerdictOptions& verdict) {
  const auto* const parameter = std::get_if<storyboard::ParameterCondition>(&condition.what);
  if (parameter == nullptr) return;
  for (const Criterion& criterion : kCriteria) {
    if (core::lowerCase(condition.name) != criterion.name &&
        core::lowerCase(parameter->name) != criterion.name)
      continue;
    const auto limit = criterion.given ? core::parseNumber(parameter->value) : 0.0;
    if (!limit || *limit < 0.0) {
      throw InputError(condition.source.text() + ": '" + condition.name + "' has the value '" +
                       core::shortened(parameter->value) + "'; expected a distance in meters");
    }
    verdict.*criterion.limit = *limit;
  }
}

/// A session passes that ends without a contact that is the ego's fault and meets the criteria of
/// the stop trigger.
VerdictOptions rules(const Scenario& scenario) {
  VerdictOptions verdict = VerdictOptions::standard();
  verdict.minimum_route_completion = 0.0;
  if (!scenario.stop) return verdict;
  for (const auto& group : scenario.stop->groups)
    for (const storyboard::Condition& condition : group) addCriterion(condition, verdict);
  return verdict;
}

}  // namespace

bool isOpenScenario(const std::string& name_or_file) {
  return core::endsWith(name_or_file, ".xosc");
}

ScenarioOptions openScenarioOptions(const std::string& file, const ScenarioOptions& base,
                                    bool own_network) {
  const Scenario scenario = storyboard::readScenario(file, true);
  if (own_network && !core::isFile(scenario.network)) {
    throw InputError(scenario.network_source.text() + ": there is no network file '" +
                     scenario.network + "'; give one by --network");
  }
  const Entity& ego = egoOf(scenario);
  requireUsableNames(scenario, ego);
  requirePlaces(scenario, ego);
  ScenarioOptions options = base;
  options.name = scenario.name;
  options.storyboard.file = std::filesystem::absolute(file).string();
  options.network = scenario.network;
  options.demand = "none";
  options.verdict = rules(scenario);
  const double speed = startSpeedOf(scenario, ego.name);
  options.route.start_speed = speed;
  if (speed > 0.5) options.target_speed = speed;  // an ego that starts from rest is to drive, too
  const std::string planner = plannerOf(ego, planners::Role::kEgo);
  if (!planner.empty()) options.ego_planner = planner;
  chooseCbvs(scenario, ego, options);
  return options;
}

std::shared_ptr<const storyboard::Play> readPlay(const StoryboardOptions& options,
                                                 const map::ImportedNetwork& import,
                                                 const map::LaneGraph& graph) {
  if (options.file.empty()) return nullptr;
  Scenario scenario = storyboard::readScenario(options.file, options.ignore_unsupported);
  const std::string ego = egoOf(scenario).name;
  requireUsableNames(scenario, egoOf(scenario));
  requirePlaces(scenario, egoOf(scenario));
  const std::string text = core::readFile(import.source, "network");
  std::optional<map::OpenDriveRoads> roads;
  if (text.find("<OpenDRIVE") != std::string::npos) roads.emplace(text, import.source.string());
  return std::make_shared<const storyboard::Play>(std::move(scenario), graph, std::move(roads),
                                                  ego);
}

namespace {

using PlacesOfEntities = std::map<std::string, storyboard::MapPose>;

storyboard::MapPose resolved(const storyboard::Play& play, const storyboard::Position& position,
                             const PlacesOfEntities& placed) {
  return play.places.resolve(position, [&](const std::string& entity) {
    const auto found = placed.find(entity);
    if (found != placed.end()) return found->second;
    throw InputError("'" + entity + "' is not placed before this refers to it");
  });
}

/// Where <Init> places the entities, by name.
PlacesOfEntities startPlaces(const storyboard::Play& play) {
  PlacesOfEntities placed;
  for (const storyboard::InitAction& init : play.scenario.init)
    if (const auto* to = std::get_if<storyboard::TeleportAction>(&init.action.what))
      placed[init.entity] = resolved(play, to->to, placed);
  return placed;
}

/// The points that <Init> gives the ego to drive through, in the map frame.
std::vector<Eigen::Vector3d> waypointsOf(const storyboard::Play& play,
                                         const PlacesOfEntities& placed) {
  std::vector<Eigen::Vector3d> points;
  for (const storyboard::InitAction& init : play.scenario.init) {
    const auto* const route = std::get_if<storyboard::RouteAction>(&init.action.what);
    if (init.entity != play.ego || route == nullptr) continue;
    for (const storyboard::Position& waypoint : route->waypoints) {
      const storyboard::MapPose place = resolved(play, waypoint, placed);
      points.emplace_back(place.pose.position.x(), place.pose.position.y(), place.elevation);
    }
  }
  return points;
}

}  // namespace

map::Route egoRouteOf(const storyboard::Play& play) {
  const Entity& ego = *play.scenario.find(play.ego);
  const PlacesOfEntities placed = startPlaces(play);
  const auto found = placed.find(play.ego);
  if (found == placed.end())
    throw InputError(ego.source.text() + ": the ego has no <TeleportAction> in <Init>");
  storyboard::MapPose start = found->second;
  start.pose.position = start.pose.toMap(ego.center);
  std::vector<Eigen::Vector3d> points = waypointsOf(play, placed);
  if (!points.empty()) return play.places.routeThrough(start, std::move(points));
  const auto route = play.places.routeFrom(start);
  if (route) return *route;
  throw InputError(ego.source.text() + ": the ego starts on no lane of its heading");
}

}  // namespace cdiff::session
