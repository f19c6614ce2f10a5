// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "map/import/network_import.h"

namespace cdiff::exchange {

/// "car", "truck" or "bicycle", as both formats call a body: results hold boxes alone.
const char* vehicleWord(const traffic::VehicleDimensions& size);

/// Which part of a session is exported.
struct SceneOptions {
  double from = 0.0;         ///< [s] of the session
  std::optional<double> to;  ///< [s]; absent: its end
  std::string vehicles = "ego,cbv,near";

  /// Throws InputError unless 0 <= from < to and the vehicles are "all" or some of ego, cbv, near.
  void validate() const;
};

/// A vehicle at one tick of the scene: center of the box, map frame, SI units.
struct SceneState {
  std::uint64_t step = 0;      ///< ticks since the start of the scene
  traffic::VehicleState pose;  ///< the heading is continuous, not wrapped
};

/// The course of one vehicle through the scene.
struct SceneVehicle {
  std::string id;
  traffic::VehicleRole role =
      traffic::VehicleRole::kBackground;  ///< CBV when it was one at any tick
  traffic::VehicleDimensions dimensions;
  std::vector<SceneState> states;  ///< one a tick while it is there, at least one
};

/// How a session came about and what came of it, for files and for the index.
struct SceneFacts {
  std::string scenario;
  std::int64_t seed = 0;
  std::string mode;
  std::string method;
  std::string ego_planner;
  std::string cbv_planner;
  std::string status;
  std::string verdict;
  std::string trace_sha256;
  std::optional<double> contact_seconds;  ///< first contact of the ego with a CBV, else with anyone
  std::string contact_with;               ///< id of the other vehicle
  bool contact_with_cbv = false;
};

/// A recorded session as other programs can replay it: network, courses of the chosen vehicles and
/// where the session comes from. Map frame, SI units; time counts from the start of the scene.
struct RecordedScene {
  SceneFacts facts;
  double step = 0.05;       ///< time of a tick [s]
  std::uint64_t steps = 0;  ///< last tick of the scene
  map::ImportedNetwork import;
  std::vector<SceneVehicle> vehicles;  ///< the ego first, then in the order of the trace
  bool sizes_known = true;             ///< false: the result lacks vehicles.csv; all are cars of
                                       ///< 4.5 m x 1.8 m

  /// Time of a tick since the start of the scene [s].
  double seconds(std::uint64_t tick) const { return static_cast<double>(tick) * step; }
  /// Length of the scene [s].
  double duration() const { return seconds(steps); }
};

/// Facts of a session's result folder. Throws InputError naming the file.
SceneFacts readFacts(const std::filesystem::path& folder);

/// Reads a session's result folder. Throws InputError naming the file for a folder without a
/// result, a trace that is not the summary's, a network that is not the session's, and times beyond
/// its end.
RecordedScene readScene(const std::filesystem::path& folder, const SceneOptions& options);

}  // namespace cdiff::exchange
