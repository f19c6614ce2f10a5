// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/guidance/guidance_report.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planning {

/// What a planner may keep for the session; all references outlive the planner.
struct PlanningContext {
  const map::RoadNetwork& network;
  const map::DrivableArea& drivable_area;
  std::uint64_t seed = 1;
  double simulation_step = 0.05;          ///< [s]
  double decision_period = 0.1;           ///< [s]
  const map::Route* ego_route = nullptr;  ///< for forecasts of the ego; may be null
};

/// How a vehicle drives, for planners that follow by IDM (defaults: PDM-Lite's).
struct DrivingStyle {
  double minimum_gap = 4.0;    ///< s0 behind a leader [m]
  double time_headway = 0.25;  ///< T [s]
  double acceleration = 0.0;   ///< a; 0 leaves the pedals to PDM-Lite, which switches them [m/s^2]
  double deceleration = 3.0;   ///< b, comfortable, where a is given [m/s^2]
  bool even() const { return acceleration > 0.0; }
};

/// One vehicle to drive at this decision.
struct PlanningTask {
  int slot = traffic::kEgoSlot;  ///< that, or of a CBV
  const traffic::Vehicle* vehicle = nullptr;
  const map::Route* route = nullptr;            ///< ego route, or the CBV's conflict-aware route
  double target_speed = 8.0;                    ///< v* before the lane's limit [m/s]
  const traffic::CameraImage* image = nullptr;  ///< its front view, for planners that see
  DrivingStyle style = {};
};

/// A state and the action that leads to it; a plan is a list of these (plan step 0.1 s), for
/// display.
struct RolloutPoint {
  traffic::VehicleState state;
  traffic::ControlAction action;
};

/// What a planner decided for one vehicle: the action to apply, with the rollout and the report it
/// comes from.
struct PlannedAction {
  int slot = traffic::kEgoSlot;
  std::string vehicle_id;
  traffic::ControlAction action;
  std::vector<RolloutPoint> rollout;    ///< may be empty
  std::string fault{};                  ///< why `action` is the fail-safe action; empty when none
  guidance::GuidanceReport guidance{};  ///< what guidance did; set by planners that are guided
  double state_mismatch = 0.0;  ///< largest distance of planned states from what the dynamics does
                                ///< with the planned actions [m]
};

/// The one interface of everything that drives: at a decision, an action for each of its vehicles.
class Planner {
 public:
  virtual ~Planner() = default;
  /// Actions for all tasks of a decision, in their order (slot order). Deterministic: same calls,
  /// same actions.
  virtual std::vector<PlannedAction> plan(const traffic::TrafficSnapshot& snapshot,
                                          const std::vector<PlanningTask>& tasks) = 0;
  /// Whether its tasks must come with images.
  virtual bool needsImages() const { return false; }
};

}  // namespace cdiff::planning
