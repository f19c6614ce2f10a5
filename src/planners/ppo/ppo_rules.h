// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planners {

// What a CBV of the PPO baseline sees, does and is rewarded for, as RIFT and FREA define it
// (CBVNormalObservation, CBVAction, CBVFullTrainReward). SI units.

inline constexpr std::size_t kPpoRows = 4;
inline constexpr std::size_t kPpoColumns = 6;
inline constexpr std::size_t kPpoInputs = kPpoRows * kPpoColumns;
inline constexpr std::size_t kPpoActions = 2;

/// Rows of an observation: the CBV, the ego, the vehicle nearest to the CBV, the goal.
enum PpoRow : std::size_t { kPpoSelf = 0, kPpoEgo = 1, kPpoNearest = 2, kPpoGoal = 3 };

/// Observation [4, 6], row by row, not normalized, in the CBV's body frame: x, y, length, width
/// [m], heading relative to the CBV's in (-pi, pi] [rad], speed along its own heading [m/s]. The
/// row of the goal holds x, y, 4, 4 [m], the route's heading there [rad] and the distance [m]; the
/// row of the nearest vehicle is 0 where none but the ego is within 60 m on the CBV's level.
using PpoObservation = std::array<float, kPpoInputs>;

/// Output of the actor: [0] times 3 m/s^2 is the acceleration, [1] times 0.3 the steer.
using PpoAction = std::array<float, kPpoActions>;

/// Where a CBV is to go (map frame): a point of the ego's route and the route's heading there.
struct PpoGoal {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  double heading = 0.0;                                ///< [rad]
};

/// Points of the ego's local route, 1 m apart, the first of them 2.5 m ahead of the ego's center:
/// RIFT keeps 12 points, and drops those before the last but one that is within 4 m, which leaves
/// the first between 2 and 3 m ahead.
inline constexpr int kPpoLocalRoutePoints = 12;
inline constexpr double kPpoLocalRouteSpacing = 1.0;  ///< [m]
inline constexpr double kPpoLocalRouteStart = 2.5;    ///< [m]
/// A goal nearer than this to the CBV's center is reached [m].
inline constexpr double kPpoGoalRadius = 4.0;

/// The point one third along the local route of an ego that is `ego_arc_length` along its route:
/// point 12 / 3, 6.5 m ahead of it. Beyond its end the route goes straight on.
PpoGoal ppoGoal(const map::Route& ego_route, double ego_arc_length);

/// Distance of a CBV's center from the goal [m].
double ppoGoalDistance(const PpoGoal& goal, const traffic::VehicleState& cbv);

/// What `cbv` sees; `ego` is the snapshot's. A value that is not finite comes from a state that is
/// not; a vehicle whose place is not finite is not the nearest.
PpoObservation ppoObservation(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego,
                              const traffic::Vehicle& cbv, const PpoGoal& goal);

/// Name of the first value that is not finite ("speed of the ego"); empty when all are.
std::string ppoNotFinite(const PpoObservation& observation);

/// Pedals and steer of an action, a = clip(3 [0], -3, 3) m/s^2: throttle a / 3 where a > 0, else
/// brake -a / 8 (RIFT's branch for vehicles that do not reverse; published is reverse gear with
/// throttle -a / 3). Steer clip(0.3 [1], -0.3, 0.3), positive left. Throws std::invalid_argument
/// for an action that is not finite.
traffic::ControlAction ppoCommand(const PpoAction& action);

/// What happened to a CBV between two decisions.
struct PpoOutcome {
  double distance_before = 0.0;  ///< from the goal of then [m]
  double distance_now = 0.0;     ///< from the goal of now [m]
  bool touched_other = false;    ///< contact with anything but the ego
  bool reached_goal = false;
};

/// clip(distance before - distance now, -1, 1) - 15 [touched another than the ego] + 15 [goal
/// reached]. Contact with the ego costs nothing.
double ppoReward(const PpoOutcome& outcome);

}  // namespace cdiff::planners
