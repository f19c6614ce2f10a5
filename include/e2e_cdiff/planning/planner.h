// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/guidance/guidance_options.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/planning/camera_views.h"
#include "e2e_cdiff/planning/perception.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planning {

/// One vehicle to drive at this decision.
struct PlanningTask {
  int slot = traffic::kEgoSlot;               ///< that, or of a CBV
  const traffic::Vehicle* vehicle = nullptr;  ///< in the snapshot; never null
  const map::Route* route = nullptr;          ///< ego route, or the CBV's conflict-aware route
  double target_speed = 8.0;                  ///< v* before the lane's limit [m/s]
  CameraViews views = {};                     ///< of its cameras, for planners that need some
};

/// A state and the action that leads to it; a plan is a list of these (plan step 0.1 s).
struct RolloutPoint {
  traffic::VehicleState state;    ///< map frame
  traffic::ControlAction action;  ///< during the plan step before it
};

/// What a planner decided for one vehicle: the action to apply, with the rollout and the report it
/// comes from.
struct PlannedAction {
  int slot = traffic::kEgoSlot;         ///< of the task
  std::string vehicle_id;               ///< of the task's vehicle
  traffic::ControlAction action;        ///< to apply until the next decision
  std::vector<RolloutPoint> rollout;    ///< may be empty
  std::string fault{};                  ///< why `action` is the fail-safe action; empty when none
  guidance::GuidanceReport guidance{};  ///< what guidance did; set by planners that are guided
  double state_mismatch = 0.0;  ///< largest distance of planned states from what the dynamics does
                                ///< with the planned actions [m]
  std::vector<PlannedCandidate>
      candidates{};                         ///< in the planner's own order; empty: it weighs none
  std::vector<AttendedVehicle> attended{};  ///< in the planner's own order; empty: it does not say
  Perception perception{};                  ///< empty: it sees nothing, or does not say
};

/// The fail-safe action for a task; with a reason it is a fault, "vehicle 'ID': REASON; full
/// braking instead".
PlannedAction failSafeAction(const PlanningTask& task, const std::string& reason = "");

/// The one interface of everything that drives: at a decision, an action for each of its vehicles.
/// What its tasks hold for it, camera views above all, its PlannerDescriptor says.
class Planner {
 public:
  virtual ~Planner() = default;
  /// Actions for all tasks of a decision, in their order (slot order). Deterministic: same calls,
  /// same actions.
  virtual std::vector<PlannedAction> plan(const traffic::TrafficSnapshot& snapshot,
                                          const std::vector<PlanningTask>& tasks) = 0;
  /// Follows this guidance from the next call of `plan` on. Planners that are not guided do
  /// nothing. Throws InputError, and follows what it followed before, for guidance that it cannot
  /// follow.
  virtual void setGuidance(const guidance::GuidanceOptions&) {}
};

}  // namespace cdiff::planning
