// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "planners/pdm_lite/idm.h"
#include "planners/pdm_lite/pdm_lite_options.h"

namespace cdiff::planners {

// PDM-Lite's rules that read the route from a vehicle's arc length [m] on it: initial target speed,
// lane change near, who leads, who trails, the next light, the next stop sign; and its IDM speeds.

/// min(share x limit, task's target speed, limit, the configuration's top speed), capped where a
/// junction lies within 30 m [m/s]. The limit is the lowest one within the distance of braking at 4
/// m/s^2: SUMO's lanes inside junctions carry the speed of their curve (CARLA's roads do not).
double initialTargetSpeed(const PdmLiteOptions& options, const map::Route& route, double arc_length,
                          double speed, double task_speed);

/// Whether the route changes lane within the next max(20, min(rest, (v_kmh / 10)^2 / 2 + 10)) m or
/// the last 15 m.
bool nearLaneChange(const map::Route& route, double arc_length, double speed);

/// Within 2.5 m of the next 80 m of the route and heading along it within 35 degrees.
bool isLeading(const map::Route& route, double arc_length, const traffic::VehicleState& other);

/// Vehicles farther than this from `vehicle` cannot be leading [m].
double leaderReach(const map::Route& route, double arc_length,
                   const traffic::VehicleState& vehicle);

/// Within 3 m (6 m when a lane change lies in the last 15 m) of the past 80 m and heading along it
/// within 30 degrees.
bool isTrailing(const map::Route& route, double arc_length, const traffic::VehicleState& other);

/// Distance to the stop line of the first light ahead that is not green ('G', 'g') nor switched off
/// ('o', 'O') [m].
std::optional<double> distanceToRedLight(const map::Route& route, double arc_length,
                                         const traffic::TrafficSnapshot& snapshot);

/// Stop signs as RIFT obeys them: one that the vehicle stands at (below 0.1 m/s, its center less
/// than 3 m before the line) is cleared, and stays so until the next one is farther than 10 m.
/// State of one vehicle, one call per decision.
class StopSignRule {
 public:
  /// Distance to the line of the next stop sign that is not cleared [m].
  std::optional<double> distance(const map::Route& route, double arc_length, double speed);

 private:
  bool cleared_ = false;
};

/// Whether a vehicle is a bicycle. Snapshots carry sizes and no vehicle classes: SUMO's bicycles
/// are 0.65 m wide, its mopeds 0.8 m.
bool isBicycle(const traffic::VehicleDimensions& dimensions);

/// Target on a free road [m/s]: the desired speed, or for an even style IDM's approach to it,
/// slowing down by no more than b.
double freeSpeed(const DrivingStyle& style, double speed, double desired);

/// IDM speed behind a leader, or a bicycle in the way [m/s].
double idmBehind(const DrivingStyle& style, const traffic::Vehicle& self,
                 const traffic::Vehicle& leader, double desired);

/// IDM speed behind something ahead, with its own gap and headway [m/s].
double idmBehind(const DrivingStyle& style, const IdmObstacle& obstacle, double speed,
                 double desired);

/// A stop line: where it is and how far before it to stand.
struct StopLine {
  double distance = 0.0;      ///< from the vehicle's center along the route [m]
  double minimum_gap = 6.0;   ///< s0, from the center [m]
  double time_headway = 0.1;  ///< T [s]
};

/// The line of a light that is not green: s0 = 6 m, T = 0.1 s.
StopLine lineOfLight(double distance);

/// The line of a stop sign: s0 = 2 m, T = 0.1 s.
StopLine lineOfStopSign(double distance);

/// IDM speed before a stop line [m/s].
double idmBefore(const StopLine& line, const DrivingStyle& style, double speed, double desired);

}  // namespace cdiff::planners
