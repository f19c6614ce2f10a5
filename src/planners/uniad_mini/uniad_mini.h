// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/camera_ego/bev_memory.h"
#include "planners/camera_ego/navigation.h"
#include "planners/camera_ego/waypoint_controller.h"
#include "planners/uniad_mini/plan_adjustment.h"
#include "planners/uniad_mini/uniad_mini_network.h"
#include "planning/vehicle_memory.h"

namespace cdiff::planners {

/// Options of the planner: its weights, the controller, the adjustment of plans, and what is shown
/// of what it sees.
struct UniadMiniOptions : WeightOptions {
  WaypointControllerOptions controller;
  PlanAdjustmentOptions adjustment;
  double frozen_image_time = 1.0;  ///< the same image for so long while moving is a fault [s]
  double least_score = 0.4;        ///< of vehicles and lines that are shown
  /// A quirk of the published agent, which gives no throttle above 5 m/s; 0: without it [m/s].
  double no_throttle_above = 0.0;

  UniadMiniOptions() : WeightOptions{kUniadMini.planner} {}
  void describe(core::OptionsVisitor& visitor);
};

/// UniAD mini: a compact UniAD (Hu et al. 2023) that drives by three cameras, its speed and the
/// route's next command (docs/uniad_mini.md). Remembers half a second of bird's-eye views and
/// tracks.
class UniadMiniPlanner : public planning::Planner {
 public:
  /// Of the context the network must outlive the planner. Throws InputError for a decision period
  /// other than 0.1 s and for a rig whose cameras are not those that the weights were trained with.
  UniadMiniPlanner(const UniadMiniOptions& options, const UniadMiniModel& model,
                   const planning::PlannerParts& parts);

  /// A vehicle without a route, or whose images are missing, of another size, of another tick or
  /// frozen, gets the fail-safe action and a fault that names the camera.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  struct Memory {
    WaypointController controller;
    BevMemory bevs;
    TrackMemory tracks;
    RigWatch watch;
    NavigationFollower navigation;
  };
  Memory newMemory() const;
  void drive(const planning::PlanningTask& task, Memory& memory, planning::PlannedAction& planned);
  UniadMiniInput inputOf(const planning::PlanningTask& task, const NavigationNode& next,
                         const Memory& memory) const;
  void conclude(const planning::PlanningTask& task, const UniadMiniOutput& output,
                const NavigationNode& next, Memory& memory, planning::PlannedAction& planned) const;

  UniadMiniOptions options_;
  UniadMiniArchitecture architecture_;
  UniadMiniNetwork network_;
  const map::RoadNetwork& roads_;
  double period_;
  double simulation_step_;
  rendering::CameraRig rig_;  ///< the cameras of the weights
  planning::VehicleMemory<Memory> memories_;
};

/// Occupied cells of each step, by the answer of the network.
OccupiedPlaces occupiedPlaces(const BevGrid& bev, const PredictedOccupancy& occupancy,
                              double least);

/// Occupancy of all steps, for people who look.
std::vector<planning::PerceivedOccupancy> perceivedOccupancy(const BevGrid& bev,
                                                             const PredictedOccupancy& occupancy,
                                                             const traffic::VehicleState& ego);

}  // namespace cdiff::planners
