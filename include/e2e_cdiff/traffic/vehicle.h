// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>

#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::traffic {

/// Motion state of a vehicle.
struct VehicleState {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< center of the box, map frame [m]
  double elevation = 0.0;                              ///< z of the road below the center [m]
  double heading = 0.0;                                ///< counter-clockwise from +x [rad]
  double speed = 0.0;                                  ///< along the heading, never negative [m/s]

  /// Position and heading.
  geometry::Pose2d pose() const { return {position, heading}; }
  /// Speed along the heading as a vector [m/s].
  Eigen::Vector2d velocity() const { return speed * geometry::direction(heading); }
};

/// Size of a vehicle's box [m].
struct VehicleDimensions {
  double length = 4.5;  ///< along the heading
  double width = 1.8;   ///< across it
  double height = 1.5;  ///< above the road
};

/// Executable command of a vehicle: throttle in [0, 1], steer in [-1, 1] (positive left), brake in
/// [0, 1]; without unit.
struct ControlAction {
  double throttle = 0.0;  ///< [0, 1]
  double steer = 0.0;     ///< [-1, 1], positive left
  double brake = 0.0;     ///< [0, 1]

  /// Whether all three are finite and in range.
  bool valid() const;
  /// Throttle 0, steer 0, brake 1.
  static ControlAction failSafe() { return {0.0, 0.0, 1.0}; }
};

bool operator==(const ControlAction& left, const ControlAction& right);

/// Who drives a vehicle: the ego's planner, the planner of the CBVs, or SUMO.
enum class VehicleRole { kEgo, kCbv, kBackground };

/// "ego", "cbv" or "background".
const char* toText(VehicleRole role);

/// Id of the ego in every snapshot.
inline constexpr const char* kEgoId = "ego";
/// Stands for the ego where vehicles are numbered by slot (CBVs have 0 and above).
inline constexpr int kEgoSlot = -1;

/// One vehicle of a snapshot: all that is known about it at one tick (map frame, SI units; position
/// = center of its box).
struct Vehicle {
  std::string id;                               ///< stable over the session
  VehicleRole role = VehicleRole::kBackground;  ///< who drives it
  int cbv_slot = -1;                            ///< slot of a CBV, else -1
  VehicleState state;                           ///< at this tick
  VehicleDimensions dimensions;                 ///< of its box
  double acceleration = 0.0;  ///< mean rate of change of speed over the last tick [m/s^2]
  double yaw_rate = 0.0;      ///< mean rate of change of heading over the last tick [rad/s]
  std::optional<ControlAction>
      applied_action;   ///< held during the last tick; absent when SUMO drives it
  std::string lane_id;  ///< SUMO lane it is on; empty off the road

  /// Its box in the plane, in the map frame.
  geometry::OrientedBox box() const {
    return {state.position, state.heading, dimensions.length, dimensions.width};
  }
};

/// Elevations farther apart than this [m] are different levels: lower than any bridge, higher than
/// any slope within a vehicle's length.
inline constexpr double kLevelHeight = 2.5;

/// Whether two elevations [m] are so far apart that boxes there cannot touch (bridges).
inline bool onDifferentLevels(double first_elevation, double second_elevation) {
  return std::abs(first_elevation - second_elevation) > kLevelHeight;
}

inline bool onDifferentLevels(const Vehicle& first, const Vehicle& second) {
  return onDifferentLevels(first.state.elevation, second.state.elevation);
}

// A rollout tau = [states; actions] as a matrix of T rows x 7 columns (SI units, body frame of the
// vehicle at planning time): row t pairs the action a_t with the state s_{t+1} that it leads to
// (paper III-C1).

/// Columns of a rollout; states first.
enum RolloutColumn : int {
  kRolloutX = 0,         ///< [m]
  kRolloutY = 1,         ///< [m]
  kRolloutHeading = 2,   ///< [rad], not wrapped
  kRolloutSpeed = 3,     ///< [m/s]
  kRolloutThrottle = 4,  ///< [0, 1]
  kRolloutSteer = 5,     ///< [-1, 1], positive left
  kRolloutBrake = 6,     ///< [0, 1]
};
inline constexpr int kStateColumns = 4;
inline constexpr int kActionColumns = 3;
inline constexpr int kRolloutColumns = kStateColumns + kActionColumns;
/// Time from one row to the next [s].
inline constexpr double kRolloutStep = 0.1;

/// A rollout [T, 7] in metric units, by the columns above.
using Rollout = Eigen::Matrix<double, Eigen::Dynamic, kRolloutColumns, Eigen::RowMajor>;

}  // namespace cdiff::traffic
