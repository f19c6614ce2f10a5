// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "planning/plan_tracker.h"

namespace cdiff::planning {

/// A steering angle with a speed or an acceleration (fields as in msg/AckermannCommand.msg).
struct AckermannCommand {
  double steering_angle = 0.0;           ///< of the front wheel, positive left [rad]
  double steering_angle_velocity = 0.0;  ///< most change of it, 0: at once [rad/s]
  bool by_acceleration = false;          ///< `acceleration` is what to do, not a limit
  double speed = 0.0;                    ///< to reach [m/s]
  double acceleration = 0.0;             ///< most change of speed either way, 0: at once [m/s^2]
  double jerk = 0.0;                     ///< most change of the acceleration, 0: at once [m/s^3]
};

/// Where the vehicle's center is to be, and when.
struct TimedPlace {
  double time = 0.0;                                   ///< of the simulation [s]
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< map frame [m]
};

/// Speed and yaw rate, as `cmd_vel` gives them.
struct VelocityCommand {
  double speed = 0.0;     ///< [m/s]
  double yaw_rate = 0.0;  ///< [rad/s]
};

/// Turns the commands of driving stacks into throttle, steer and brake, one call per decision. All
/// throw core::InputError for a command that the vehicle cannot follow or that is not finite; the
/// text says what was expected.
class EgoCommands {
 public:
  /// `period`: from decision to decision [s].
  EgoCommands(const dynamics::BicycleModelOptions& vehicle, double period);

  /// Angles up to the vehicle's steering_gain, speeds from 0.
  traffic::ControlAction follow(const traffic::Vehicle& ego, const AckermannCommand& command) const;
  /// Steers on the circle of radius speed / yaw_rate; at speed 0 it brakes and keeps straight.
  traffic::ControlAction follow(const traffic::Vehicle& ego, const VelocityCommand& command) const;
  /// By the tuned PlanTracker: places every 0.1 s from `now` [s] to the last one, straight between
  /// those given and from the ego to the first. Times must rise and end after `now`.
  traffic::ControlAction follow(const traffic::Vehicle& ego, double now,
                                const std::vector<TimedPlace>& trajectory);

 private:
  traffic::ControlAction pedals(const traffic::Vehicle& ego, double acceleration) const;

  dynamics::BicycleModel model_;
  double period_;
  PlanTracker tracker_;
};

}  // namespace cdiff::planning
