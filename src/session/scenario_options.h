// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cbv/cbv_selector.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/metrics/metrics_options.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/rendering/camera_rig.h"
#include "map/route_source.h"
#include "planners/registry.h"
#include "rendering/range_sensor.h"
#include "session/protocol.h"
#include "session/steering.h"
#include "session/target_speed.h"
#include "simulation/demand_generator.h"
#include "simulation/sumo_simulator.h"

namespace cdiff::session {

/// The rules by which a session is judged; the defaults are none.
struct VerdictOptions {
  bool judge = true;                       ///< false: as if there were no rules
  double minimum_route_completion = 0.0;   ///< least route completion of the ego [%]
  double maximum_contacts_at_fault = 1e9;  ///< contacts that are the ego's fault
  std::string excuse_unavoidable =
      "by_mode";  ///< true | false | by_mode (true in safety_critical): whether a contact that no
                  ///< braking would have avoided counts as one without fault
  std::string contact_without_fault =
      "allowed";  ///< allowed | struck | failed | by_mode: failed where CBVs drive naturalistically
                  ///< and struck where they attack
  double minimum_driving_score = 0.0;   ///< least driving score of the ego, by the protocol [%]
  double minimum_ego_distance = 0.0;    ///< least distance that the ego drives [m]
  double maximum_ego_collisions = 1e9;  ///< contacts
  double maximum_red_lights = 1e9;      ///< run by the ego
  double maximum_stop_signs = 1e9;      ///< not obeyed by the ego
  double maximum_outside_lanes_percent = 100.0;  ///< share of the ego's route [%]
  double maximum_cbv_off_road_percent = 100.0;   ///< [%]
  std::vector<std::string>
      statuses;  ///< allowed final statuses; empty: all but error and interrupted

  void describe(core::OptionsVisitor& visitor);
  /// What excuse_unavoidable is in a mode.
  bool excusesUnavoidable(const std::string& mode) const;
  /// Rules for routes that bring none of their own, and those of the shipped scenarios: the route
  /// driven to 90 %, neither blocked nor deviated, no contact at fault, others by mode.
  static VerdictOptions standard();
};

/// How the traffic is simulated.
struct SimulationOptions {
  std::string link = "libtraci";  ///< libtraci: SUMO as a process; libsumo: in the session's own

  void describe(core::OptionsVisitor& visitor);
};

/// What passes between the session and an external ego.
struct EgoOptions {
  std::string command = "control";  ///< control | ackermann | trajectory | cmd_vel
  double object_range = 100.0;      ///< of /ego/objects, from center to center [m]
  rendering::RangeSensorOptions laser = rendering::RangeSensorOptions::laser();
  rendering::RangeSensorOptions lidar = rendering::RangeSensorOptions::lidar();

  void describe(core::OptionsVisitor& visitor);
};

/// What the report holds.
struct ReportOptions {
  double front_view_rate = 2.5;  ///< pictures a second of each CBV's front view; 0: none

  void describe(core::OptionsVisitor& visitor);
};

/// The story that a session plays with its own vehicles.
struct StoryboardOptions {
  std::string file;                 ///< *.xosc; empty: none
  bool ignore_unsupported = false;  ///< go on without what is not supported

  void describe(core::OptionsVisitor& visitor);
};

/// A scenario: everything that decides a session, as one YAML file (schema of `cdiff validate`).
struct ScenarioOptions {
  ScenarioOptions();

  std::int64_t schema_version = 1;
  std::string name = "unnamed";
  std::string network;                ///< shipped name or file (*.net.xml, *.xodr, *.osm)
  map::RouteOptions route;            ///< route of the ego
  StoryboardOptions storyboard;       ///< its ego starts where it says, where no route is given
  std::string demand = "generated";   ///< generated | none | a *.rou.xml file
  simulation::DemandOptions traffic;  ///< generated demand
  double begin_time = 0.0;            ///< SUMO's clock at the start, for demand files [s]
  std::string lights = "green";       ///< green | program
  std::string mode = "naturalistic";  ///< naturalistic | challenging | safety_critical
  std::string method = "default";     ///< shipped method, whose values lie below all other keys
  std::string ego_planner = planners::kDefaultEgoPlanner;
  std::string cbv_planner = planners::kDefaultCbvPlanner;
  std::int64_t max_cbv = 2;
  cbv::CbvOptions cbv;
  planning::PlannerOptionsTable planner_options =
      planners::defaultOptions();  ///< groups by their names
  std::string guidance_profile;    ///< shipped profile or file; empty: the method's for the mode
  guidance::GuidanceOptions guidance;  ///< the CBVs': the profile's values, with what is changed
  std::string ego_guidance_profile = "naturalistic";  ///< shipped profile or file
  guidance::GuidanceOptions ego_guidance;  ///< the ego's, where its planner can be guided
  rendering::CameraOptions camera;         ///< the front camera, and what all cameras share
  EgoOptions ego;                          ///< topics of an external ego
  rendering::RigOptions ego_rig;           ///< cameras of the ego
  rendering::RigOptions cbv_rig;           ///< cameras of the CBVs
  dynamics::BicycleModelOptions vehicle;
  SimulationOptions simulation;
  simulation::SumoOptions sumo;
  ProtocolOptions protocol;
  metrics::MetricsOptions metrics;
  VerdictOptions verdict;
  ReportOptions report;
  std::vector<SteeringEntry> steering;  ///< what changes while the session runs
  bool video = false;                   ///< also write session.mp4
  double target_speed = 8.0;            ///< v* [m/s], capped by the lane's limit
  CbvSpeedOptions cbv_target_speed;     ///< v* of CBVs where each has its own
  double simulation_step = 0.05;        ///< [s]
  double decision_period = 0.1;         ///< [s], a multiple of simulation_step
  double real_time_factor = 0.0;        ///< pace of nodes that the wall clock rules; 0: lockstep
  double at_most = 0.0;                 ///< times real time, in lockstep; 0: as fast as possible
  std::int64_t seed = 1;

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for fields that contradict each other.
  void validate() const;
  /// Of the modes that the scenario begins with or is steered to, the one that attacks most.
  std::string fiercestMode() const;

 private:
  void describeTraffic(core::OptionsVisitor& visitor);
  void describePlanners(core::OptionsVisitor& visitor);
  void describeTime(core::OptionsVisitor& visitor);
  void validateTime() const;
  void validateCameras() const;
};

/// Reads a scenario by file name, or by the name of one in config/scenarios. Relative paths inside
/// it are resolved against the file's folder; keys that it does not name keep the values of `base`.
/// Throws InputError naming file, line and key, or the nearest shipped scenario.
ScenarioOptions loadScenario(const std::string& name_or_file, const ScenarioOptions& base = {});

/// Names of the shipped scenarios, sorted.
std::vector<std::string> shippedScenarios();

}  // namespace cdiff::session
