// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cbv/cbv_selector.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "map/import/network_import.h"
#include "metrics/session_metrics.h"
#include "session/scenario_options.h"
#include "session/storyboard_scenario.h"
#include "session/vehicle_rigs.h"

namespace cdiff::session {

/// What every part of a session derives from its scenario: network, drivable area, lane graph, ego
/// route. The same in every deployment.
class SessionSetup {
 public:
  /// Imports the network that the scenario names and plans the ego route.
  explicit SessionSetup(const ScenarioOptions& options);
  /// The same from an imported network's text and the ego route's points, as a recording or the
  /// session's topic holds them.
  SessionSetup(const ScenarioOptions& options, map::ImportedNetwork import,
               const std::vector<Eigen::Vector3d>& ego_route_points);
  SessionSetup(const SessionSetup&) = delete;
  SessionSetup& operator=(const SessionSetup&) = delete;

  const ScenarioOptions& options() const { return options_; }
  const map::ImportedNetwork& import() const { return import_; }
  const map::RoadNetwork& network() const { return roads_->network; }
  const map::LaneGraph& graph() const { return roads_->graph; }
  const map::DrivableArea& drivableArea() const { return roads_->drivable_area; }
  /// Always matched from its points, so that every deployment has the same.
  const map::Route& egoRoute() const { return ego_route_; }
  /// The cameras of ego and CBVs.
  const VehicleRigs& rigs() const { return rigs_; }
  planning::PlanningContext planningContext() const;
  /// The planners that the scenario names; they refer to this setup. Throw InputError.
  std::unique_ptr<planning::Planner> makeEgoPlanner() const;
  std::unique_ptr<planning::Planner> makeCbvPlanner() const {
    return makeCbvPlanner(options_.cbv_planner);
  }
  /// One of another name in its place.
  std::unique_ptr<planning::Planner> makeCbvPlanner(const std::string& name) const;
  /// What chooses the CBVs, by the scenario's mode.
  std::unique_ptr<cbv::CbvSelector> makeCbvSelector() const;
  /// SUMO with the network, the demand file, the lights and the storyboard of the scenario. Throws
  /// InputError and SimulatorError as it does.
  std::unique_ptr<simulation::TrafficSimulator> makeSimulator() const;
  /// What the storyboard has that is not supported and was ignored, with file and line.
  std::vector<std::string> ignoredElements() const;
  /// v* of a CBV before the lane's limit [m/s].
  double cbvTargetSpeed(const std::string& vehicle_id) const;
  /// What the session is measured by, in every deployment.
  metrics::SessionMetricsOptions metricsOptions() const;
  /// Ticks from one decision to the next.
  std::uint64_t ticksPerDecision() const;

 private:
  /// What follows from the network's text alone.
  struct Roads {
    explicit Roads(const map::ImportedNetwork& import);
    map::RoadNetwork network;
    map::LaneGraph graph;
    map::DrivableArea drivable_area;
  };
  map::Route plannedRoute() const;
  static std::shared_ptr<const Roads> roadsOf(const map::ImportedNetwork& import);

  ScenarioOptions options_;
  VehicleRigs rigs_;
  map::ImportedNetwork import_;
  std::shared_ptr<const Roads> roads_;            ///< sessions on a network may share them
  std::shared_ptr<const storyboard::Play> play_;  ///< nullptr without a storyboard
  map::Route ego_route_;
};

}  // namespace cdiff::session
