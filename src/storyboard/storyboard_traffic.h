// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "simulation/traffic_simulator.h"
#include "storyboard/traffic_stage.h"

namespace cdiff::storyboard {

/// What a session needs of a scenario that was read: the same for its whole length.
struct Play {
  Play(Scenario read, const map::LaneGraph& graph, std::optional<map::OpenDriveRoads> roads,
       std::string ego_entity)
      : scenario(std::move(read)), places(graph, std::move(roads)), ego(std::move(ego_entity)) {}

  Scenario scenario;
  Places places;
  std::string ego;  ///< entity that the ego's planner drives
};

/// Another traffic simulator with the entities of a scenario in it. The storyboard moves them, and
/// the other simulator has them as vehicles that are driven; the session sees them as background
/// vehicles, which it may take over and give back. Time counts from the step with which the ego
/// appears.
class StoryboardTraffic : public simulation::TrafficSimulator {
 public:
  /// `play` must outlive the object; `step`: of the simulation [s]. Throws InputError for
  /// conditions on elements of the storyboard that are not there.
  StoryboardTraffic(std::unique_ptr<simulation::TrafficSimulator> traffic, const Play& play,
                    double step);

  void addDriven(const std::string& id, const traffic::VehicleDimensions& dimensions,
                 const simulation::DrivenVehicle& start) override;
  void takeOver(const std::string& id) override;
  bool release(const simulation::DrivenVehicle& vehicle) override;
  bool addBackground(const std::string& id, const std::vector<std::string>& edges,
                     double depart_position, int depart_lane, double depart_speed,
                     const traffic::VehicleDimensions& dimensions) override {
    return traffic_->addBackground(id, edges, depart_position, depart_lane, depart_speed,
                                   dimensions);
  }
  void remove(const std::string& id) override;
  /// Throws InputError with file and line for an action that cannot be.
  void step(const std::vector<simulation::DrivenVehicle>& driven) override;
  const std::vector<simulation::SimulatedVehicle>& vehicles() const override { return vehicles_; }
  const std::vector<traffic::SignalState>& signals() const override { return traffic_->signals(); }
  std::string version() const override { return traffic_->version(); }
  bool over() const override { return storyboard_.over(); }

 private:
  bool isOurs(const std::string& id) const;
  void observe(const std::vector<simulation::DrivenVehicle>& driven);
  void advance(const std::vector<simulation::DrivenVehicle>& driven);
  std::vector<simulation::DrivenVehicle> moves();
  void collectVehicles(const std::vector<std::string>& moved);

  std::unique_ptr<simulation::TrafficSimulator> traffic_;
  const Play& play_;
  TrafficStage stage_;
  Storyboard storyboard_;
  double step_;
  std::uint64_t steps_ = 0;  ///< since the ego is there
  bool begun_ = false;
  std::set<std::string> added_;  ///< in the other simulator
  std::set<std::string> taken_;  ///< that planners drive
  std::vector<simulation::SimulatedVehicle> vehicles_;
};

}  // namespace cdiff::storyboard
