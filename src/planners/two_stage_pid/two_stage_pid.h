// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "planners/diffusion/diffusion_planner.h"
#include "planning/vehicle_memory.h"
#include "planning/windowed_pid.h"

namespace cdiff::planners {

/// Gains and limits of TrajectoryTracker; defaults as published for Pluto and RIFT.
struct TrajectoryTrackerOptions {
  planning::PlanPidOptions pids;
  double look_ahead_time = 0.5;      ///< [s]
  double look_ahead_distance = 2.5;  ///< at standstill, before the limits [m]
  double look_ahead_minimum = 5.0;   ///< [m]
  double look_ahead_maximum = 8.0;   ///< [m]

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError unless look_ahead_minimum <= look_ahead_maximum.
  void validate() const;
  /// Distance of the place to aim at [m].
  double lookAhead(double speed) const;
};

/// Makes one vehicle follow planned places (its body frame, m, one per 0.1 s) with PlanPids: the
/// published execution of Pluto and RIFT. One call per decision.
///
/// The plan is thinned to one place a second (two a second if it is shorter than 2 s).
///  - Desired speed: mean length of the segments between these places, from the vehicle on, per
///    time.
///  - Turn error: toward the place whose distance is nearest to the look-ahead
///    clamp(0.5 v + 2.5, 5, 8) m; none while it stands (below kStandstill).
class TrajectoryTracker {
 public:
  static constexpr double kStandstill = 0.01;  ///< slower than this it does not steer [m/s]

  explicit TrajectoryTracker(const TrajectoryTrackerOptions& options = {});
  /// Action at `speed` [m/s] for the planned `places` [T, 2]: row t is where the vehicle is to be
  /// at (t + 1) 0.1 s. A plan without rows is one to stand still.
  traffic::ControlAction track(double speed, const Eigen::MatrixX2d& places);

 private:
  double turnError(double speed, const Eigen::MatrixX2d& places) const;

  TrajectoryTrackerOptions options_;
  planning::PlanPids pids_;
};

/// The diffusion planner with its denoised actions left out (the paper's two-stage variant): the
/// planned states, in the vehicle's body frame, are followed by a PID tracker. Same model, guidance
/// and noise as `diffusion`, so that only the execution differs.
class TwoStagePid : public planning::Planner {
 public:
  /// Takes over `planner`, which makes the plans.
  TwoStagePid(std::unique_ptr<DiffusionPlanner> planner, const TrajectoryTrackerOptions& options);

  /// The action is the tracker's; rollout, guidance and state mismatch are those of the plan, its
  /// denoised actions included. A vehicle with a fault keeps the fail-safe action and its tracker
  /// starts over, as does that of a vehicle left out of a decision.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;
  bool needsImages() const override { return true; }

 private:
  std::unique_ptr<DiffusionPlanner> planner_;
  TrajectoryTrackerOptions options_;
  planning::VehicleMemory<TrajectoryTracker> trackers_;
};

}  // namespace cdiff::planners
