// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::learning {

// Scenes: all that any learner needs of a session, without its images, which are rendered again
// from it to the same bytes. `*.scene` files hold one session each; `cdiff collect --scenes` writes
// them (collection/scene_recorder.h).

/// How the driver of a vehicle drives (SI units): target speed, and the style of
/// planners::DrivingStyle.
struct SceneDriver {
  double target_speed = 8.0;   ///< v* before the lane's limit [m/s]
  double minimum_gap = 4.0;    ///< s0 behind a leader [m]
  double time_headway = 0.25;  ///< T [s]
  double acceleration = 0.0;   ///< a [m/s^2]; 0: full or no pedal
  double deceleration = 3.0;   ///< b [m/s^2]
};

/// A stretch during which one vehicle was driven along one route (map frame, SI units).
struct SceneDrive {
  std::string vehicle_id;
  std::uint64_t selected_tick = 0;
  SceneDriver driver;
  double interaction_score = 0.0;                            ///< at selection, in [0, 1]
  Eigen::Vector3d conflict_point = Eigen::Vector3d::Zero();  ///< as selected [m]
  std::vector<Eigen::Vector3d> route_points;                 ///< about 1 m apart [m]
  std::vector<std::string> route_lanes;                      ///< id of the lane of each point
};

/// A session as a scene file holds it: network, routes, drivers, and every decision's snapshot (map
/// frame, SI units, doubles as they were). Its snapshots keep what learners use: vehicles and
/// signals; contacts of all ticks are listed apart; faults and what was removed are left out.
struct Scene {
  std::string name;                   ///< scenario and seed
  std::string scenario_yaml;          ///< resolved, every key: camera, dynamics, periods, planners
  std::string network_source;         ///< what the user named
  std::string network_source_sha256;  ///< of that file
  std::string network_text;           ///< as the simulator loaded it
  std::vector<SceneDrive> drives;     ///< the ego's first
  std::vector<traffic::TrafficSnapshot> decisions;            ///< in order
  std::vector<std::map<int, std::size_t>> driven;             ///< by decision: slot -> drive
  std::set<std::pair<std::string, std::uint64_t>> disturbed;  ///< noise or fault: vehicle, tick
  std::vector<std::pair<std::uint64_t, traffic::Contact>> contacts;  ///< by tick
  double seconds = 0.0;                                              ///< simulated
};

/// Which moments of scenes become samples of a learner.
struct SceneSampleOptions {
  double period = 0.5;           ///< between two samples of a vehicle [s]
  double standing_share = 0.25;  ///< part kept of moments at which it stands
  double lowest_speed = 0.0;     ///< of drivers whose target speed lies in between [m/s]
  double highest_speed = 100.0;  ///< [m/s]

  void describe(core::OptionsVisitor& visitor);
  /// Decisions from one sample to the next.
  std::size_t stride() const;
  bool wants(double target_speed) const {
    return target_speed >= lowest_speed && target_speed <= highest_speed;
  }
};

/// Between the decisions of scenes that planners learn from [s].
inline constexpr double kScenePeriod = 0.1;
/// Throws InputError naming scene and decisions where they are not kScenePeriod apart; `learner`:
/// who learns from it.
void requireScenePeriod(const Scene& scene, const std::string& learner);
/// Whether a vehicle moved from one decision to the next as its speeds say, up to 0.5 m.
bool drivesOn(const traffic::VehicleState& before, const traffic::VehicleState& after);

/// The route of a drive in the scene's network. Throws InputError naming scene and lane that the
/// network lacks.
map::Route routeOf(const Scene& scene, const SceneDrive& drive, const map::RoadNetwork& network);

}  // namespace cdiff::learning
