// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/new_scenario.h"

#include "core/scratch_folder.h"
#include "core/text.h"
#include "core/yaml_text.h"
#include "planners/registry.h"
#include "suite/crossing_networks.h"

namespace cdiff::suite {
namespace {

std::string edgesText(const SuggestedRoute& route) {
  std::vector<std::string> edges;
  for (const std::string& edge : route.edges) edges.push_back(core::yamlQuoted(edge));
  return "[" + core::joinText(edges, ", ") + "]";
}

/// Routes that could stand in the place of the scenario's, as comments.
std::string othersText(const std::vector<SuggestedRoute>& others) {
  std::string text;
  for (const SuggestedRoute& other : others) {
    text += "  # " + routeText(other) + ": edges: " + edgesText(other) +
            ", start_offset: " + core::formatNumber(other.start_offset) +
            ", end_offset: " + core::formatNumber(other.end_offset) + "\n";
  }
  return text.empty() ? "" : "  # Others that this network offers:\n" + text;
}

std::string routeGroup(const NewScenario& scenario) {
  const SuggestedRoute& route = scenario.route;
  return "# What the ego drives: " + routeText(route) + ".\nroute:\n" +
         "  # SUMO edges in driving order.\n  edges: " + edgesText(route) +
         "\n  # Start of the ego from the first edge's start, and goal from the last edge's end "
         "[m].\n  start_offset: " +
         core::formatNumber(route.start_offset) +
         "\n  end_offset: " + core::formatNumber(route.end_offset) +
         "\n  # Speed of the ego at the start [m/s].\n  start_speed: 6\n" +
         othersText(scenario.others);
}

constexpr const char* kTrafficGroups = R"(
# Background traffic: generated, none, or a SUMO route file of yours (*.rou.xml).
demand: generated
traffic:
  # Vehicles kept alive near the ego.
  density: 20
  # They begin within this distance of the ego's route [m].
  radius: 120
# Traffic lights: green for all, who then yield as without lights, or program as in the network.
lights: green

# Critical background vehicles (CBVs): naturalistic, or safety_critical to have them attack.
mode: naturalistic
# Most of them at a time.
max_cbv: 2

# Planners: any that `cdiff validate --planners` lists; ego_planner: external is a node of your own.
)";

constexpr const char* kRuleGroups = R"(
# Speed that planners aim at, capped by the lane's limit [m/s].
target_speed: 8

# When a session ends. any_length gives a route of any length enough time.
protocol:
  preset: any_length

# What passes. Without these rules no session can fail.
verdict:
  # Least share of the route [%].
  minimum_route_completion: 90
  # blocked and deviated fail.
  statuses: [completed, timed_out, collided]
  # Contacts that are the ego's fault.
  maximum_contacts_at_fault: 0
  # Any other contact fails in naturalistic, and counts as struck in safety_critical.
  contact_without_fault: by_mode

)";

}  // namespace

namespace {

std::string plannerKeys() {
  return std::string("ego_planner: ") + planners::kDefaultEgoPlanner +
         "\ncbv_planner: " + planners::kDefaultCbvPlanner;
}

}  // namespace

std::string newScenarioText(const NewScenario& scenario) {
  return "# Scenario " + scenario.name + ", made by `cdiff new`. Every key and its range: `cdiff " +
         "validate --print FILE`.\n\n# Version of this file format.\nschema_version: 1\n" +
         "# Name of the scenario in results.\nname: " + scenario.name +
         "\n# Road network: a file, relative to this one, or a shipped name.\nnetwork: " +
         core::yamlQuoted(scenario.network) + "\n\n" + routeGroup(scenario) + kTrafficGroups +
         plannerKeys() + kRuleGroups +
         "# Root seed of every random draw: another one gives other traffic.\nseed: " +
         std::to_string(scenario.seed) + "\n";
}

std::string generatedNetwork(const std::string& kind, std::int64_t seed) {
  const core::ScratchFolder scratch;
  const std::filesystem::path folder = scratch.path() / "network";
  if (kind == "grid") return buildNetwork(gridPlan(kind, 4, 120.0), folder);
  NetworkSpec spec;
  spec.name = kind;
  spec.kind = kind == "roundabout" ? NetworkKind::kRoundabout : NetworkKind::kCrossing;
  Draws draws(core::RandomStream(static_cast<std::uint64_t>(seed), "new " + kind), 0);
  return buildNetwork(drawNetwork(spec, draws), folder);
}

}  // namespace cdiff::suite
