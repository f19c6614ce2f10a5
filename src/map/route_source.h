// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "map/lane_graph.h"

namespace cdiff::map {

// Where an ego route comes from: SUMO edges, points, or a route of a Bench2Drive file.

/// Exactly one of edges, points and bench2drive_file is given.
struct RouteOptions {
  std::vector<std::string> edges;       ///< SUMO edges in driving order
  std::vector<Eigen::Vector3d> points;  ///< key points in the map frame [m]
  std::string bench2drive_file;         ///< route file of Bench2Drive
  std::string bench2drive_id;           ///< id of the route in that file
  double start_offset = 5.0;            ///< the ego's center, from the first edge's start [m]
  double end_offset = 5.0;              ///< the goal, from the last edge's end [m]
  double start_speed = 0.0;             ///< the ego's speed at the start [m/s]

  void describe(core::OptionsVisitor& visitor);
  /// Whether any source is given.
  bool given() const { return !edges.empty() || !points.empty() || !bench2drive_file.empty(); }
  /// Throws InputError when not exactly one source is given.
  void validate() const;
};

/// Key points of a Bench2Drive route in the map frame: (x + ox, -y + oy, z). Throws InputError
/// naming the file, the id and the nearest known ids.
std::vector<Eigen::Vector3d> readBench2DriveRoute(const std::string& file, const std::string& id,
                                                  const RoadNetwork& network);

/// One route of a Bench2Drive file.
struct Bench2DriveEntry {
  std::string id;
  std::string town;
};

/// All routes of a file in its order. Throws InputError for a file that is none.
std::vector<Bench2DriveEntry> listBench2DriveRoutes(const std::string& file);

/// Town of a Bench2Drive route ("Town05"); throws InputError as above.
std::string bench2DriveTown(const std::string& file, const std::string& id);

/// Lane-connected route along the centerlines of the lanes that key points lie on; points nearer
/// than 0.1 m to the one before are merged. Throws InputError naming the point (counted from 0)
/// that is more than 1.5 m off every lane's centerline and outside every lane, has no
/// lane-connected route to the next, or one longer than twice their distance + 20 m.
Route routeThroughPoints(const LaneGraph& graph, const std::vector<Eigen::Vector3d>& points);

/// Lane-connected route along edges. Throws InputError naming an unknown edge (with the nearest id)
/// or two edges without connection.
Route routeAlongEdges(const LaneGraph& graph, const std::vector<std::string>& edges,
                      double start_offset, double end_offset);

/// The route that the options describe.
Route makeRoute(const LaneGraph& graph, const RouteOptions& options);

}  // namespace cdiff::map
