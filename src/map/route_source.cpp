// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/route_source.h"

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::map {

void RouteOptions::describe(core::OptionsVisitor& visitor) {
  visitor.list({"edges", "", "SUMO edges of the route in driving order"}, edges);
  visitor.points({"points", "m", "key points of the route in the map frame"}, points);
  visitor.text({"bench2drive_file", "", "route file of Bench2Drive"}, bench2drive_file, {});
  visitor.text({"bench2drive_id", "", "id of the route in bench2drive_file"}, bench2drive_id, {});
  visitor.number(
      {"start_offset", "m", "distance of the start from the first edge's beginning, with edges"},
      start_offset, 0.0, 1e5);
  visitor.number({"end_offset", "m", "distance of the goal from the last edge's end, with edges"},
                 end_offset, 0.0, 1e5);
  visitor.number({"start_speed", "m/s", "speed of the ego at the start"}, start_speed, 0.0, 60.0);
}

void RouteOptions::validate() const {
  const int sources =
      (edges.empty() ? 0 : 1) + (points.empty() ? 0 : 1) + (bench2drive_file.empty() ? 0 : 1);
  if (sources != 1) {
    throw core::InputError(
        "the route has " + std::to_string(sources) +
        " sources; exactly one of edges, points and bench2drive_file was expected");
  }
  if (points.size() == 1) {
    throw core::InputError("the route has 1 point; at least two were expected");
  }
  if (bench2drive_file.empty() == bench2drive_id.empty()) return;
  throw core::InputError(bench2drive_id.empty()
                             ? "bench2drive_file '" + bench2drive_file + "' needs bench2drive_id"
                             : "bench2drive_id '" + bench2drive_id + "' needs bench2drive_file");
}

namespace {

Route bench2DriveRoute(const LaneGraph& graph, const RouteOptions& options) {
  const std::string& file = options.bench2drive_file;
  const std::string& id = options.bench2drive_id;
  try {
    return routeThroughPoints(graph, readBench2DriveRoute(file, id, graph.network()));
  } catch (const core::InputError& error) {
    const std::string town = bench2DriveTown(file, id);
    throw core::InputError("route '" + id + "' of '" + file + "' is for " + town +
                           "; on this network: " + error.what());
  }
}

}  // namespace

Route makeRoute(const LaneGraph& graph, const RouteOptions& options) {
  options.validate();
  if (!options.bench2drive_file.empty()) return bench2DriveRoute(graph, options);
  if (!options.points.empty()) return routeThroughPoints(graph, options.points);
  return routeAlongEdges(graph, options.edges, options.start_offset, options.end_offset);
}

}  // namespace cdiff::map
