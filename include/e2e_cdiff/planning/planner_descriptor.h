// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/guidance/guidance_options.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/planning/planner_options.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/rendering/camera_rig.h"

namespace cdiff::planning {

/// What a planner may keep for the session; all references outlive the planner.
struct PlanningContext {
  const map::RoadNetwork& network;         ///< of the session
  const map::DrivableArea& drivable_area;  ///< of that network
  std::uint64_t seed = 1;                  ///< root seed of the session
  double simulation_step = 0.05;           ///< [s]
  double decision_period = 0.1;            ///< [s]
  const map::Route* ego_route = nullptr;   ///< for forecasts of the ego; may be null
};

/// Name of the ego's planner where a node of the user's own drives it.
inline constexpr const char* kExternalPlanner = "external";

/// What a planner is made of. References outlive the planner, as those of the context do.
struct PlannerParts {
  PlanningContext context;                       ///< what it may keep for the session
  const PlannerOptionsTable& options;            ///< of all planners of the scenario
  const dynamics::BicycleModelOptions& vehicle;  ///< how its vehicles move
  const rendering::CameraOptions& camera;        ///< that the vehicle's images come from
  const guidance::GuidanceOptions& guidance;     ///< of planners that are guided
  std::string guidance_group = "guidance.";      ///< before its keys in errors
  rendering::RigOptions rig_options = {};        ///< cameras of the planner's vehicles, as given
  std::string rig_key = "ego_rig";               ///< their key in errors
  rendering::CameraRig rig = {};  ///< what they are, filled in by makePlanner; copy what is kept
};

/// The network behind a planner, for the record of a session.
struct NetworkFacts {
  std::string model;         ///< shipped name, or folder of its weight files
  std::string conditioning;  ///< what it is given, in the planner's own words
  std::string sampling;      ///< how a decision comes from it, likewise
  std::map<std::string, std::string> instruction_sets;  ///< by key in session.yaml
};

/// What is known about a planner before one is made: name, roles, needs, options and constructor.
/// Scenario files, the node graph, reports, tables and error texts read descriptors only.
struct PlannerDescriptor {
  std::string name;                  ///< in scenario files, snake_case
  std::string title;                 ///< in tables, as its authors write it
  std::string help;                  ///< one sentence
  bool drives_ego = true;            ///< whether it can be the ego's planner
  bool drives_cbv = true;            ///< whether it can be the planner of CBVs
  std::vector<std::string> cameras;  ///< names of the cameras that it needs; none: it sees nothing
  std::string rig = rendering::kFrontRig;  ///< preset that its vehicles have unless the scenario
                                           ///< says otherwise; holds `cameras`
  bool guided = false;                     ///< follows guidance objectives
  /// Program that runs it for the CBVs in the node graph.
  std::string cbv_node = "cbv_planner_node";
  /// Its options with their defaults.
  std::function<std::unique_ptr<PlannerOptions>()> options;
  /// Throws InputError naming the key of an option that it cannot work with.
  std::function<std::unique_ptr<Planner>(const PlannerParts&)> make;
  /// Empty where the planner has no network.
  std::function<NetworkFacts(const PlannerOptionsTable&, const guidance::GuidanceOptions&)> network;
  /// SHA-256 over the weight files of the network; throws InputError when one cannot be read.
  std::function<std::string(const PlannerOptionsTable&)> weights_sha256;

  /// Whether it needs images: its tasks come with the views of its cameras.
  bool sees() const { return !cameras.empty(); }
};

}  // namespace cdiff::planning
