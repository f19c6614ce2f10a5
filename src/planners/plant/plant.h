// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/planning/planner.h"
#include "planners/plant/plant_network.h"
#include "planning/route_follower.h"
#include "planning/windowed_pid.h"

namespace cdiff::planners {

/// Options of the planner: its weights, and the gains of its PIDs as published for PlanT.
struct PlantOptions {
  std::string weights = "plant";
  double turn_kp = 0.9;
  double turn_ki = 0.75;
  double turn_kd = 0.3;
  double speed_kp = 5.0;
  double speed_ki = 0.5;
  double speed_kd = 1.0;
  std::int64_t window = 20;         ///< errors in the mean, zeros at the start
  double speed_error_limit = 0.25;  ///< [m/s]
  double max_throttle = 0.75;
  double brake_speed = 0.4;    ///< desired speed below which it brakes [m/s]
  double brake_ratio = 1.1;    ///< speed / desired speed above which it brakes
  double steer_damping = 0.5;  ///< on the steering while it brakes

  void describe(core::OptionsVisitor& visitor);
  void validate() const {}
  /// The folder of the weights.
  std::filesystem::path folder() const;
};

/// Makes one vehicle follow PlanT's waypoints with two PIDs (PlanT, section 3): desired speed
/// 2 |w1 - w0| per second, aim (w0 + w1) / 2. Turn error: bearing of the aim in units of 90
/// degrees, 0 while it brakes; speed error limited to [0, speed_error_limit]. It brakes fully below
/// brake_speed and above brake_ratio x desired speed. One call per decision (published: 0.1 s).
class WaypointTracker {
 public:
  explicit WaypointTracker(const PlantOptions& options);
  /// `speed` [m/s].
  traffic::ControlAction track(double speed, const PlantWaypoints& waypoints);

 private:
  PlantOptions options_;
  planning::WindowedPid turn_;
  planning::WindowedPid speed_;
};

/// PlanT: a transformer over vehicles and route plans waypoints, which a PID follows. It knows all
/// boxes around it, no map and not its own speed (docs/plant.md).
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
  std::string faultOf(const traffic::TrafficSnapshot& snapshot,
                      const planning::PlanningTask& task) const;
  void conclude(const planning::PlanningTask& task, const PlantInput& input,
                const PlantOutput& output, planning::PlannedAction& planned);

  PlantOptions options_;
  PlantArchitecture architecture_;
  PlantNetwork network_;
  std::map<std::string, Memory> memories_;  ///< by vehicle
};

}  // namespace cdiff::planners
