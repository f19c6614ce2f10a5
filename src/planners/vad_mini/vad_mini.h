// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/camera_ego/bev_memory.h"
#include "planners/camera_ego/navigation.h"
#include "planners/camera_ego/waypoint_controller.h"
#include "planners/vad_mini/vad_mini_network.h"
#include "planning/vehicle_memory.h"

namespace cdiff::planners {

/// Options of the planner: its weights, the controller, and what is shown of what it sees.
struct VadMiniOptions : WeightOptions {
  WaypointControllerOptions controller;
  double frozen_image_time = 1.0;  ///< the same image for so long while moving is a fault [s]
  double least_score = 0.3;        ///< of vehicles and lines that are shown

  VadMiniOptions() : WeightOptions{kVadMini.planner} {}
  void describe(core::OptionsVisitor& visitor);
};

/// VAD mini: a compact VAD (Jiang et al. 2023) that drives by three cameras, its speed and the
/// route's next command (docs/vad_mini.md). Remembers half a second of bird's-eye views.
class VadMiniPlanner : public planning::Planner {
 public:
  /// Of the context the network must outlive the planner. Throws InputError for a decision period
  /// other than 0.1 s and for a rig whose cameras are not those that the weights were trained with.
  VadMiniPlanner(const VadMiniOptions& options, const VadMiniModel& model,
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
    RigWatch watch;
    NavigationFollower navigation;
  };
  Memory newMemory() const;
  void drive(const planning::PlanningTask& task, Memory& memory, planning::PlannedAction& planned);
  void conclude(const planning::PlanningTask& task, const VadMiniOutput& output,
                const NavigationNode& next, Memory& memory, planning::PlannedAction& planned) const;

  VadMiniOptions options_;
  VadMiniArchitecture architecture_;
  VadMiniNetwork network_;
  const map::RoadNetwork& roads_;
  double period_;
  double simulation_step_;
  rendering::CameraRig rig_;  ///< the cameras of the weights
  planning::VehicleMemory<Memory> memories_;
};

/// What the network saw, in the map frame: vehicles and lines with scores of at least `least`.
planning::Perception perceptionOf(const VadMiniOutput& output, const traffic::VehicleState& ego,
                                  double least);

}  // namespace cdiff::planners
