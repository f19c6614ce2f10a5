// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "dynamics/action_rollout.h"
#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/planning/planner.h"
#include "planners/pdm_lite/forecasts.h"
#include "planning/vehicle_memory.h"

namespace cdiff::planners {

/// Options of the planner `constant`.
struct ConstantSpeedOptions {
  double speed = 8.0;  ///< that it keeps, at most v*; 0: it stands still [m/s]

  void describe(core::OptionsVisitor& visitor);
  void validate() const {}
};

/// The baseline that looks at nothing but its route: each vehicle keeps the speed
/// min(constant.speed, v*) whatever is ahead of it (map frame, SI units). PDM-Lite's PID steers;
/// the pedals are those that the vehicle dynamics needs for the speed, changed by at most 3 m/s^2.
/// With speed 0, and at the end of its route, it brakes fully.
class ConstantSpeed : public planning::Planner {
 public:
  ConstantSpeed(const ConstantSpeedOptions& options, const dynamics::BicycleModelOptions& vehicle);

  /// The steering is remembered by vehicle and dropped when it is not among the tasks. A vehicle
  /// without a route, or whose state is not finite, gets the fail-safe action and a fault.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  traffic::ControlAction actionOf(const planning::PlanningTask& task, DriverState& driver) const;

  ConstantSpeedOptions options_;
  dynamics::BicycleModel model_;
  planning::VehicleMemory<DriverState> drivers_;
};

}  // namespace cdiff::planners
