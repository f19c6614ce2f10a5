// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "map/lane_graph.h"
#include "suite/network_generator.h"

namespace cdiff::suite {

/// Maneuvers in the order of tables: left, right, straight, roundabout, merge.
const std::vector<std::string>& manoeuvres();
/// Levels of traffic: low, medium, high.
const std::vector<std::string>& densities();
/// Vehicles kept alive near the ego at a level of traffic.
int vehiclesAt(const std::string& density);

/// One ego route of a suite: what it does, where, and the session it makes.
struct SuiteRoute {
  std::string name;     ///< name of the scenario
  std::string network;  ///< name of a network of the suite
  std::vector<std::string> edges;
  double start_offset = 5.0;  ///< from the first edge's start [m]
  double end_offset = 5.0;    ///< from the last edge's end [m]
  std::string manoeuvre;      ///< one of manoeuvres()
  double turn = 0.0;          ///< heading after the last junction minus before the first [deg]
  double length = 0.0;        ///< [m]
  int conflicts = 0;          ///< edges whose streams, not the ego's own, cross or join the route
  std::string density;        ///< one of densities()
  std::int64_t seed = 1;      ///< root seed of its session
};

/// Change of heading of a route from before its first junction to after its last, positive to the
/// left [deg]; 0 without junctions.
double turnAlong(const map::Route& route);

/// Edges from whose lanes, other than the route's own, streams cross or join the route between its
/// first junction and its last; 0 without junctions.
int conflictsAlong(const map::RoadNetwork& network, const map::Route& route);

/// "left", "right" or "straight"; empty where the angle [deg] is none of a maneuver's.
std::string manoeuvreAt(double turn);

constexpr double kShortestRoute = 80.0;  ///< [m]
constexpr double kLongestRoute = 200.0;  ///< [m]

/// A route along a planned path, 80 to 200 m long, its length and its part before the junction
/// drawn; name, network, density and seed are left to the caller. nullopt when the path has no lane
/// connection, is too short or too long, changes lanes, turns by an angle that is not a maneuver
/// (left and right: 45 to 135 degrees; straight: up to 25 degrees), or meets no other stream.
std::optional<SuiteRoute> planRoute(const map::LaneGraph& graph, const PlannedPath& path,
                                    Draws& draws);

/// The scenario file of a route (see docs of scenarios), its network at ../networks/NAME.
std::string scenarioText(const SuiteRoute& route);

}  // namespace cdiff::suite
