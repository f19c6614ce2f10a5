// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/planning/planner_options.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "planning/windowed_pid.h"

namespace cdiff::planning {

inline constexpr const char* kTunedTracker = "tuned";
inline constexpr const char* kPublishedTracker = "published";

/// How PlanTracker follows a plan (SI units): the named tracker and, on top of its values, single
/// keys. Defaults are those of `tuned`, what `cdiff tune` found for our vehicle dynamics;
/// `published` has what is published for the execution of Pluto and RIFT.
struct PlanTrackerOptions {
  std::string tracker = kTunedTracker;
  PlanPidOptions pids = {{1.5, 0.25, 0.0}};
  double aim_period = 0.1;           ///< from one place that may be aimed at to the next [s]
  double look_ahead_time = 0.2;      ///< [s]
  double look_ahead_distance = 2.5;  ///< at standstill, before the limits [m]
  double look_ahead_minimum = 4.5;   ///< [m]
  double look_ahead_maximum = 8.0;   ///< [m]
  double speed_horizon = 1.0;        ///< of the plan, over which the desired speed is a mean [s]
  bool steer_while_braking = true;

  /// The values of a named tracker. Throws InputError for another name, with the known ones.
  static PlanTrackerOptions named(const std::string& name);
  static PlanTrackerOptions published() { return named(kPublishedTracker); }

  /// The keys of whoever follows plans; `further` trackers may be named besides `tuned` and
  /// `published`. To name another tracker sets all other keys to its values (those of `tuned` for a
  /// further one), which single keys then change.
  void describe(core::OptionsVisitor& visitor, const std::vector<std::string>& further = {});
  /// Throws InputError unless look_ahead_minimum <= look_ahead_maximum.
  void validate() const;
  /// Distance of the place to aim at [m].
  double lookAhead(double speed) const;

 private:
  void describeName(core::OptionsVisitor& visitor, const std::vector<std::string>& further);
};

/// Gives the planners of `base` the trackers (keys NAME.tracker) that those of `named` name, so
/// that these lie below single keys, whatever the order of both.
void nameTrackers(const PlannerOptionsTable& named, PlannerOptionsTable& base);

/// A plan: where a vehicle is to be 0.1, 0.2, ... s from now, in a frame of the caller's [m]. A
/// view: the places must outlive it.
struct PlanPlaces {
  const Eigen::Vector2d* first = nullptr;
  std::size_t count = 0;
};

/// Where a vehicle is in the frame of its plan [m], the unit vector of its heading, speed [m/s].
struct PlanFollower {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  double speed = 0.0;
};

/// Mean speed that a plan asks for [m/s]: length of the segments between its places of whole
/// seconds (half seconds if it is shorter than 2 s), from the vehicle on, per time, over the whole
/// seconds of `horizon` at most. 0 for a plan without places.
double desiredSpeed(const Eigen::Vector2d& position, PlanPlaces plan, double horizon);
/// Of `places` [T, 2] in the body frame.
double desiredSpeed(const Eigen::MatrixX2d& places, double horizon);

/// Makes one vehicle follow a plan with PlanPids. One call per decision (every 0.1 s).
///  - Desired speed: desiredSpeed over speed_horizon.
///  - Turn error: toward the place that is nearest to the look-ahead clamp(look_ahead_time v +
///    look_ahead_distance, look_ahead_minimum, look_ahead_maximum), among those aim_period apart
///    (0.5 s at most if the plan is shorter than 2 s) up to the first that is beyond it, so that a
///    plan that comes back does not draw the aim away. None while the vehicle stands (below
///    kStandstill), while the place is nearer than kNearestAim, or, unless steer_while_braking,
///    while it brakes.
class PlanTracker {
 public:
  static constexpr double kStandstill = 0.01;  ///< [m/s]
  static constexpr double kNearestAim = 1.0;   ///< [m]

  explicit PlanTracker(const PlanTrackerOptions& options = {});
  /// A plan without places is one to stand still.
  traffic::ControlAction track(const PlanFollower& vehicle, PlanPlaces plan);
  /// Of `places` [T, 2] in the body frame, of a vehicle at `speed` [m/s].
  traffic::ControlAction track(double speed, const Eigen::MatrixX2d& places);

 private:
  double turnError(const PlanFollower& vehicle, PlanPlaces plan) const;

  PlanTrackerOptions options_;
  std::size_t aim_rows_;  ///< of a plan, from one place that may be aimed at to the next
  PlanPids pids_;
};

}  // namespace cdiff::planning
