// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/planning/planner.h"
#include "planners/plant/plant_network.h"
#include "planning/route_follower.h"
#include "planning/vehicle_memory.h"
#include "planning/windowed_pid.h"

namespace cdiff::planners {

/// Options of the planner: its weights, and the gains of its PIDs as published for PlanT.
struct PlantOptions : WeightOptions {
  planning::PlanPidOptions pids;
  double steer_damping = 0.5;    ///< on the steering while it brakes
  double least_own_speed = 4.0;  ///< of its own token [m/s]: else standing is followed by standing

  PlantOptions();
  void describe(core::OptionsVisitor& visitor);
};

/// Makes one vehicle follow PlanT's waypoints with PlanPids (PlanT, section 3): desired speed
/// 2 |w1 - w0| per second, aim (w0 + w1) / 2, no turn error while it brakes. One call per decision
/// (published: 0.1 s).
class WaypointTracker {
 public:
  explicit WaypointTracker(const PlantOptions& options);
  /// `speed` [m/s].
  traffic::ControlAction track(double speed, const PlantWaypoints& waypoints);

 private:
  double steer_damping_;
  planning::PlanPids pids_;
};

/// PlanT: a transformer over vehicles and route plans waypoints, which a PID follows. It knows all
/// boxes around it, its own with its speed where the weights say so, and no map (docs/plant.md).
class PlantPlanner : public planning::Planner {
 public:
  /// Throws InputError for weights that are missing or do not fit.
  PlantPlanner(const PlantOptions& options, const PlantModel& model);

  /// One pass for all vehicles. Memory is kept by vehicle and dropped when it is not among the
  /// tasks. A vehicle without a route, and every vehicle where a state in the snapshot is not
  /// finite, gets the fail-safe action and a fault.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  struct Memory {
    planning::RouteFollower follower;
    WaypointTracker tracker;
  };
  PlantInput inputOf(const traffic::TrafficSnapshot& snapshot, const planning::PlanningTask& task,
                     double arc_length) const;
  void conclude(const planning::PlanningTask& task, const PlantInput& input,
                const PlantOutput& output, planning::PlannedAction& planned);

  PlantOptions options_;
  PlantArchitecture architecture_;
  PlantNetwork network_;
  planning::VehicleMemory<Memory> memories_;
};

}  // namespace cdiff::planners
