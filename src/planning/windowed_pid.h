// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::planning {

/// Gains of a WindowedPid. They are per call, so they depend on the decision period.
struct PidGains {
  double kp = 0.0;  ///< of the error
  double ki = 0.0;  ///< of the mean error
  double kd = 0.0;  ///< of the last change of the error

  /// The keys NAME_kp, NAME_ki and NAME_kd of what steers or drives, as `output` says; `note` ends
  /// the sentence about the first.
  void describe(core::OptionsVisitor& visitor, const std::string& name, const std::string& output,
                const std::string& note = "");
};

/// PID with the mean of the last errors instead of an integral: kp e + ki mean(window) + kd (e - e
/// before). One call per decision.
class WindowedPid {
 public:
  /// `window`: errors in the mean, zeros at the start.
  WindowedPid(const PidGains& gains, std::int64_t window);
  /// Output for this error; remembers it.
  double update(double error);

 private:
  PidGains gains_;
  std::vector<double> errors_;  ///< of fixed length, in a ring
  std::size_t oldest_ = 0;      ///< its place
  double last_ = 0.0;
};

/// Gains and limits of PlanPids; defaults as published for Pluto and RIFT.
struct PlanPidOptions {
  PidGains turn{1.25, 0.75, 0.3};
  PidGains speed{5.0, 0.5, 1.0};
  std::int64_t window = 20;        ///< errors in the mean, zeros at the start
  double speed_error_limit = 1.0;  ///< [m/s]
  double max_throttle = 1.0;
  double brake_speed = 0.4;           ///< desired speed below which it brakes [m/s]
  double brake_ratio = 1.1;           ///< speed / desired speed above which it brakes
  bool steers_while_braking = false;  ///< no option: as the planner's authors publish it

  void describe(core::OptionsVisitor& visitor);
};

/// The two PIDs that make a vehicle follow a plan, as PlanT, Pluto and RIFT publish them, for a
/// decision every 0.1 s.
///  - Speed error: desired - speed, limited to [0, speed_error_limit]. It brakes fully, without
///    throttle, if the desired speed is below brake_speed or less than speed / brake_ratio.
///  - Turn error: bearing of a place of the plan, in units of 90 degrees; none while it brakes
///    unless it steers then, too.
class PlanPids {
 public:
  explicit PlanPids(const PlanPidOptions& options);
  bool brakes(double speed, double desired_speed) const;
  /// Speeds [m/s]; one call per decision.
  traffic::ControlAction track(double speed, double desired_speed, double turn_error);

 private:
  PlanPidOptions options_;
  WindowedPid turn_;
  WindowedPid speed_;
};

/// The bearing of a place in the body frame [m] in units of 90 degrees.
double turnErrorToward(const Eigen::Vector2d& place);

}  // namespace cdiff::planning
