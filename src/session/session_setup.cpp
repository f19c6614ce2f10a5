// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/session_setup.h"

#include <cmath>

#include "core/file.h"
#include "core/kept_content.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/demand_file.h"
#include "simulation/sumo_input_rules.h"

namespace cdiff::session {
namespace {

const ScenarioOptions& validated(const ScenarioOptions& options) {
  options.validate();
  return options;
}

/// As importNetwork, and refused where SUMO would write or read other files over it.
map::ImportedNetwork imported(const std::string& source) {
  map::ImportedNetwork network = map::importNetwork(source);
  const std::string name = "network '" + network.source.string() + "'";
  const bool cached = network.file != network.source;
  simulation::requirePlainPath(
      network.file,
      cached ? "cache folder '" + core::cacheFolder().string() + "' (E2E_CDIFF_CACHE)" : name);
  simulation::requireHarmlessNetwork(network.text, name);
  return network;
}

}  // namespace

SessionSetup::Roads::Roads(const map::ImportedNetwork& import)
    : network(map::RoadNetwork::fromText(import.text, import.source.string())),
      graph(network),
      drivable_area(network) {}

std::shared_ptr<const SessionSetup::Roads> SessionSetup::roadsOf(
    const map::ImportedNetwork& import) {
  return core::keptContent<Roads>("roads",
                                  import.source.string() + '\0' + core::sha256(import.text),
                                  [&] { return std::make_shared<Roads>(import); });
}

SessionSetup::SessionSetup(const ScenarioOptions& options)
    : options_(validated(options)),
      rigs_(options_),
      import_(imported(options.network)),
      roads_(roadsOf(import_)),
      play_(readPlay(options_.storyboard, import_, graph())),
      ego_route_(map::matchRoute(network(), plannedRoute().path().points())) {}

SessionSetup::SessionSetup(const ScenarioOptions& options, map::ImportedNetwork import,
                           const std::vector<Eigen::Vector3d>& ego_route_points)
    : options_(options),
      rigs_(options_),
      import_(std::move(import)),
      roads_(roadsOf(import_)),
      ego_route_(map::matchRoute(network(), ego_route_points)) {}

/// As the scenario gives it, else as its storyboard does.
map::Route SessionSetup::plannedRoute() const {
  if (play_ != nullptr && !options_.route.given()) return egoRouteOf(*play_);
  return map::makeRoute(graph(), options_.route);
}

std::vector<std::string> SessionSetup::ignoredElements() const {
  return play_ == nullptr ? std::vector<std::string>() : play_->scenario.ignored;
}

planning::PlanningContext SessionSetup::planningContext() const {
  return {network(),
          drivableArea(),
          static_cast<std::uint64_t>(options_.seed),
          options_.simulation_step,
          options_.decision_period,
          &ego_route_};
}

std::unique_ptr<planning::Planner> SessionSetup::makeEgoPlanner() const {
  return planners::makePlanner(
      options_.ego_planner,
      {planningContext(), options_.planner_options, options_.vehicle, options_.camera,
       options_.ego_guidance, "ego_guidance.", options_.ego_rig, "ego_rig"});
}

std::unique_ptr<planning::Planner> SessionSetup::makeCbvPlanner(const std::string& name) const {
  return planners::makePlanner(
      name, {planningContext(), options_.planner_options, options_.vehicle, options_.camera,
             options_.guidance, "guidance.", options_.cbv_rig, "cbv_rig"});
}

std::unique_ptr<cbv::CbvSelector> SessionSetup::makeCbvSelector() const {
  return std::make_unique<cbv::CbvSelector>(options_.cbv, static_cast<int>(options_.max_cbv),
                                            graph(), ego_route_, options_.mode);
}

std::unique_ptr<simulation::TrafficSimulator> SessionSetup::makeSimulator() const {
  simulation::SumoSession session;
  session.network_file = import_.file;
  session.network_source = import_.source;
  if (hasDemandFile(options_)) session.demand_file = options_.demand;
  session.begin_time = options_.begin_time;
  session.simulation_step = options_.simulation_step;
  session.seed = static_cast<std::uint64_t>(options_.seed);
  session.lights_green = options_.lights == "green";
  session.link = options_.simulation.link;
  auto sumo = std::make_unique<simulation::SumoSimulator>(options_.sumo, session, network());
  if (play_ == nullptr) return sumo;
  return std::make_unique<storyboard::StoryboardTraffic>(std::move(sumo), *play_,
                                                         options_.simulation_step);
}

double SessionSetup::cbvTargetSpeed(const std::string& vehicle_id) const {
  return session::cbvTargetSpeed(options_.cbv_target_speed, options_.target_speed,
                                 static_cast<std::uint64_t>(options_.seed), vehicle_id);
}

metrics::SessionMetricsOptions SessionSetup::metricsOptions() const {
  metrics::SessionMetricsOptions options;
  options.simulation_step = options_.simulation_step;
  options.decision_period = options_.decision_period;
  options.completion_percent = options_.protocol.completion_percent;
  options.completion_distance = options_.protocol.completion_distance;
  options.protocol = options_.protocol.preset;
  options.mode = options_.fiercestMode();
  options.infractions = options_.protocol.infractions;
  options.target_speed = options_.target_speed;
  options.cbv_target_speed =
      [speeds = options_.cbv_target_speed, fixed = options_.target_speed,
       seed = static_cast<std::uint64_t>(options_.seed)](const std::string& vehicle_id) {
        return session::cbvTargetSpeed(speeds, fixed, seed, vehicle_id);
      };
  options.network = &network();
  options.metrics = options_.metrics;
  return options;
}

std::uint64_t SessionSetup::ticksPerDecision() const {
  return static_cast<std::uint64_t>(
      std::llround(options_.decision_period / options_.simulation_step));
}

}  // namespace cdiff::session
