// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/route_source.h"

#include <cstdlib>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/bench2drive_file.h"

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

namespace {

double coordinate(const Bench2DriveFile& file, const std::string& id, std::size_t index,
                  const pugi::xml_node& position, const char* name) {
  const char* text = position.attribute(name).value();
  const std::optional<double> value = core::parseNumber(text);
  if (!value) {
    file.fail("route '" + id + "', position " + std::to_string(index) + ": " + name + "=\"" + text +
              "\" is not a finite number");
  }
  return *value;
}

}  // namespace

std::vector<Eigen::Vector3d> readBench2DriveRoute(const std::string& file, const std::string& id,
                                                  const RoadNetwork& network) {
  const Bench2DriveFile routes(file);
  const pugi::xml_node route = routes.route(id);
  const Eigen::Vector2d& offset = network.netOffset();
  std::vector<Eigen::Vector3d> points;
  for (const pugi::xml_node& position : route.child("waypoints").children("position")) {
    const auto read = [&](const char* name) {
      return coordinate(routes, id, points.size(), position, name);
    };
    points.emplace_back(read("x") + offset.x(), -read("y") + offset.y(), read("z"));
  }
  if (points.size() < 2) {
    routes.fail("route '" + id + "' has " + std::to_string(points.size()) +
                " positions; at least two were expected");
  }
  return points;
}

std::string bench2DriveTown(const std::string& file, const std::string& id) {
  const Bench2DriveFile routes(file);
  const std::string town = routes.route(id).attribute("town").value();
  if (town.empty()) routes.fail("route '" + id + "' names no town");
  return town;
}

std::vector<Bench2DriveEntry> listBench2DriveRoutes(const std::string& file) {
  return Bench2DriveFile(file).entries();
}

}  // namespace cdiff::map
