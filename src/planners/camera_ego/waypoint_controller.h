// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <array>

#include "e2e_cdiff/core/options.h"
#include "planning/windowed_pid.h"

namespace cdiff::planners {

/// Waypoints of camera egos: 0.5 s apart, the first one that far ahead (body frame [m]).
inline constexpr std::int64_t kEgoWaypoints = 6;
inline constexpr double kEgoWaypointPeriod = 0.5;  ///< [s]
using EgoWaypoints = std::array<Eigen::Vector2d, kEgoWaypoints>;

/// Gains and rules of the controller, as published for TCP, UniAD and VAD on Bench2Drive, but for
/// two gains of the steering, chosen on training routes (docs/vad_mini.md): kp 2.25 in place of
/// 0.75, which is for CARLA's vehicle, and ki 0 in place of 0.75: the mean of 40 errors steers on
/// for 4 s after a turn.
struct WaypointControllerOptions {
  planning::PlanPidOptions pids;
  double aim_distance = 4.0;  ///< of the waypoint that is steered at [m]
  double target_angle = 0.3;  ///< difference of target and last segment that is an outlier [90 deg]
  double target_distance = 10.0;  ///< of the target below which that counts [m]

  WaypointControllerOptions();
  void describe(core::OptionsVisitor& visitor);
};

/// Waypoints to an action (Wu et al. 2022, TCP): desired speed = mean length of the segments / 0.5
/// s; aim = begin of the segment whose middle is nearest to the aim distance; the route's target
/// point is aimed at instead where its angle is smaller, or where it differs from the last
/// segment's by more than target_angle and is nearer than target_distance ahead. It steers while
/// braking, too. One call per decision.
class WaypointController {
 public:
  explicit WaypointController(const WaypointControllerOptions& options);
  /// `speed` [m/s]; `target` in the body frame [m].
  traffic::ControlAction track(double speed, const EgoWaypoints& waypoints,
                               const Eigen::Vector2d& target);

 private:
  double turnError(const EgoWaypoints& waypoints, const Eigen::Vector2d& target) const;

  WaypointControllerOptions options_;
  planning::PlanPids pids_;
};

/// Mean length of the segments between waypoints / 0.5 s [m/s].
double desiredSpeed(const EgoWaypoints& waypoints);

}  // namespace cdiff::planners
