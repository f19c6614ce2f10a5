// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/route_source.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/bench2drive_file.h"
#include "map/lane_candidates.h"
#include "map/lane_search.h"
#include "map/route_builder.h"

namespace cdiff::map {
namespace {

constexpr double kMergeDistance = 0.1;  // [m] key points nearer than this are one
constexpr double kHeadingScale =
    0.6;                            // [rad] toward the next key point, which may lie behind a bend
constexpr double kBackwards = 0.5;  // [m] a projection may fall back by so much on its lane
constexpr double kFarSearch = 20000.0;  // distinguishes a long route from none [m]

/// Joins key points by the cheapest choice of lanes and the shortest routes between them.
class KeyPointRoute {
 public:
  KeyPointRoute(const RoadNetwork& network, const std::vector<Eigen::Vector3d>& points)
      : network_(network), points_(distinctPoints(points, kMergeDistance)) {
    const CandidateFinder finder(network_, points_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      layers_.push_back(finder.find(points_[i], headingAt(i), kHeadingScale));
    }
  }

  Route build() const {
    const CheapestChoice choice = cheapestChoice(
        layers_,
        [this](std::size_t layer, const LaneCandidate& from) { return transitions(layer, from); });
    if (choice.positions.empty()) fail(choice.reached);
    return join(choice.positions);
  }

 private:
  double headingAt(std::size_t i) const {
    const std::size_t begin = std::min(i, points_.size() - 2);
    const Eigen::Vector3d along = points_[begin + 1].position - points_[begin].position;
    return std::atan2(along.y(), along.x());
  }

  double distanceAfter(std::size_t layer) const {
    return (points_[layer + 1].position - points_[layer].position).head<2>().norm();
  }

  static double limitFor(double distance) { return 2.0 * distance + 20.0; }

  static bool goesOn(const LanePosition& from, const LanePosition& to) {
    return from.lane == to.lane && to.arc_length >= from.arc_length - kBackwards;
  }

  std::vector<double> transitions(std::size_t layer, const LaneCandidate& from) const {
    const double distance = distanceAfter(layer);
    SearchLimits limits;
    limits.max_length = limitFor(distance);
    const LaneSearch search(network_, from.position, limits);
    std::vector<double> costs;
    for (const LaneCandidate& to : layers_[layer + 1]) {
      const bool direct = goesOn(from.position, to.position);
      const double rank = direct ? to.position.arc_length - from.position.arc_length
                                 : search.arrivalAt(to.position).rank;
      costs.push_back(rank < kInfinity ? std::abs(rank - distance) : kInfinity);
    }
    return costs;
  }

  Route join(const std::vector<LanePosition>& positions) const {
    LanePosition here = positions.front();
    std::vector<LaneStretch> drive = {{here.lane, here.arc_length, here.arc_length}};
    for (std::size_t i = 1; i < positions.size(); ++i) {
      const LanePosition& goal = positions[i];
      if (goesOn(here, goal)) {
        drive.back().end = std::max(drive.back().end, goal.arc_length);
      } else {
        const auto path = LaneSearch(network_, here, SearchLimits()).pathTo(goal);
        if (!path) fail(i - 1);
        appendPath(network_, *path, here.arc_length, goal.arc_length, drive);
      }
      here = {goal.lane, drive.back().end};
    }
    return buildRoute(network_, drive);
  }

  /// Shortest route between any candidates of two neighboring points, however long [m].
  double shortestRoute(std::size_t layer) const {
    double shortest = kInfinity;
    SearchLimits limits;
    limits.max_length = kFarSearch;
    for (const LaneCandidate& from : layers_[layer]) {
      const LaneSearch search(network_, from.position, limits);
      for (const LaneCandidate& to : layers_[layer + 1]) {
        shortest = std::min(shortest, search.arrivalAt(to.position).driven);
      }
    }
    return shortest;
  }

  [[noreturn]] void fail(std::size_t reached) const {
    const InputPoint& from = points_[reached];
    const InputPoint& to = points_[reached + 1];
    const double distance = distanceAfter(reached);
    const double length = shortestRoute(reached);
    if (length > limitFor(distance) && length < kInfinity) {
      throw core::InputError("route from point " + std::to_string(from.index) + " " +
                             toText(from.position) + " to point " + std::to_string(to.index) + " " +
                             toText(to.position) + " is " + core::formatFixed(length, 1) +
                             " m for a distance of " + core::formatFixed(distance, 1) +
                             " m (limit twice the distance + 20 m)");
    }
    throw core::InputError("no lane-connected route from point " + std::to_string(from.index) +
                           " " + toText(from.position) + " to point " + std::to_string(to.index) +
                           " " + toText(to.position));
  }

  const RoadNetwork& network_;
  std::vector<InputPoint> points_;
  CandidateLayers layers_;
};

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

Route routeThroughPoints(const LaneGraph& graph, const std::vector<Eigen::Vector3d>& points) {
  return KeyPointRoute(graph.network(), points).build();
}

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

Route makeRoute(const LaneGraph& graph, const RouteOptions& options) {
  options.validate();
  if (!options.bench2drive_file.empty()) return bench2DriveRoute(graph, options);
  if (!options.points.empty()) return routeThroughPoints(graph, options.points);
  try {
    return routeAlongEdges(graph, options.edges, options.start_offset, options.end_offset);
  } catch (const core::InputError& error) {
    throw core::InputError("group 'route' (edges, start_offset, end_offset): " +
                           std::string(error.what()));
  }
}

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

namespace {

/// A lane of one edge of the list and the cheapest route to it.
struct EdgeLane {
  LaneIndex lane = kNoLane;
  double cost = kInfinity;
  std::vector<LaneIndex> before;  ///< lanes between the lane that it is reached from and itself
  std::size_t parent = 0;         ///< place of that lane in its own layer
  bool beside = false;            ///< reached from a neighbor of the same edge
};

/// Chooses one lane row through a list of edges: connected, and with the fewest lane changes.
class EdgeRow {
 public:
  EdgeRow(const RoadNetwork& network, const std::vector<std::string>& edges)
      : network_(network), edges_(edges) {}

  LanePath choose() {
    for (const std::string& edge : edges_) addLayer(edge);
    for (EdgeLane& first : layers_.front()) first.cost = 0.0;
    for (std::size_t i = 0; i + 1 < layers_.size(); ++i) {
      if (i > 0) spreadBeside(layers_[i]);  // the first edge is entered on the lane that suits
      advance(i);
    }
    return trace();
  }

 private:
  void addLayer(const std::string& edge) {
    const std::vector<LaneIndex> lanes = network_.lanesOfEdge(edge);
    if (lanes.empty()) {
      throw core::InputError("unknown edge '" + edge + "'; the nearest name in this network is '" +
                             core::nearestName(edge, network_.edgeIds()) + "'");
    }
    std::vector<EdgeLane> layer;
    for (const bool slow_too : {false, true}) {
      for (const LaneIndex index : lanes) {
        const Lane& lane = network_.lane(index);
        if (!lane.routable && !(slow_too && lane.allows_cars)) continue;
        layer.push_back({index, kInfinity, {}, 0, false});
      }
      if (!layer.empty()) break;
    }
    if (layer.empty()) throw core::InputError("edge '" + edge + "' has no lane that cars may use");
    layers_.push_back(std::move(layer));
  }

  /// Lane changes inside an edge, from right to left and back.
  void spreadBeside(std::vector<EdgeLane>& layer) const {
    const auto relax = [&](std::size_t from, std::size_t to) {
      const Lane& lane = network_.lane(layer[from].lane);
      if (lane.left != layer[to].lane && lane.right != layer[to].lane) return;
      const double cost = layer[from].cost + laneChangePenalty(lane, lane.centerline.length());
      if (cost >= layer[to].cost) return;
      layer[to] = {layer[to].lane, cost, {}, from, true};
    };
    for (std::size_t i = 0; i + 1 < layer.size(); ++i) relax(i, i + 1);
    for (std::size_t i = layer.size(); i-- > 1;) relax(i, i - 1);
  }

  void advance(std::size_t i) {
    for (std::size_t from = 0; from < layers_[i].size(); ++from) {
      if (layers_[i][from].cost < kInfinity) follow(i, from, {layers_[i][from].lane});
    }
    const auto open = [](const EdgeLane& lane) { return lane.cost < kInfinity; };
    if (std::any_of(layers_[i + 1].begin(), layers_[i + 1].end(), open)) return;
    throw core::InputError("no connection for cars from edge '" + edges_[i] + "' to edge '" +
                           edges_[i + 1] + "'" + successorsText(edges_[i]));
  }

  static constexpr std::size_t kLongestChain = 9;  ///< a lane and internal lanes in a row

  /// Follows links through the junction after edge `i`; `route` starts with the lane left and ends
  /// with the lane reached.
  void follow(std::size_t i, std::size_t from, const std::vector<LaneIndex>& lanes) {
    for (const LaneLink& link : network_.lane(lanes.back()).next) {
      const Lane& next = network_.lane(link.to);
      if (!next.allows_cars) continue;
      std::vector<LaneIndex> longer = lanes;
      if (next.internal) {
        longer.push_back(link.to);
        if (longer.size() <= kLongestChain) follow(i, from, longer);
        continue;
      }
      for (EdgeLane& lane : layers_[i + 1]) {
        if (lane.lane != link.to || layers_[i][from].cost >= lane.cost) continue;
        lane = {lane.lane, layers_[i][from].cost, {lanes.begin() + 1, lanes.end()}, from, false};
      }
    }
  }

  std::string successorsText(const std::string& edge) const {
    std::vector<std::string> found;
    std::vector<LaneIndex> open = network_.lanesOfEdge(edge);
    for (std::size_t i = 0; i < open.size(); ++i) {
      for (const LaneLink& link : network_.lane(open[i]).next) {
        const Lane& next = network_.lane(link.to);
        if (next.internal && std::find(open.begin(), open.end(), link.to) == open.end())
          open.push_back(link.to);
        if (!next.internal) found.push_back("'" + next.edge_id + "'");
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    if (found.empty()) return "; it leads nowhere";
    return "; it leads to " + core::joinText(found, ", ");
  }

  LanePath trace() const {
    const auto cheaper = [](const EdgeLane& left, const EdgeLane& right) {
      return left.cost < right.cost;
    };
    const std::vector<EdgeLane>& last = layers_.back();
    auto place = static_cast<std::size_t>(std::min_element(last.begin(), last.end(), cheaper) -
                                          last.begin());
    LanePath path;
    for (std::size_t i = layers_.size(); i-- > 0;) {
      while (layers_[i][place].beside) {
        path.lanes.push_back(layers_[i][place].lane);
        place = layers_[i][place].parent;
      }
      const EdgeLane& lane = layers_[i][place];
      path.lanes.push_back(lane.lane);
      path.lanes.insert(path.lanes.end(), lane.before.rbegin(), lane.before.rend());
      place = lane.parent;
    }
    std::reverse(path.lanes.begin(), path.lanes.end());
    return path;
  }

  const RoadNetwork& network_;
  const std::vector<std::string>& edges_;
  std::vector<std::vector<EdgeLane>> layers_;
};

}  // namespace

Route routeAlongEdges(const LaneGraph& graph, const std::vector<std::string>& edges,
                      double start_offset, double end_offset) {
  if (edges.empty()) throw core::InputError("a route along edges needs at least one edge");
  const RoadNetwork& network = graph.network();
  const LanePath path = EdgeRow(network, edges).choose();
  const double first_length = network.lane(path.lanes.front()).centerline.length();
  const double last_length = network.lane(path.lanes.back()).centerline.length();
  const double goal = last_length - end_offset;
  const auto fail = [](const std::string& edge, double length, const std::string& what) {
    throw core::InputError("edge '" + edge + "' is " + core::formatFixed(length, 2) + " m long; " +
                           what);
  };
  if (start_offset >= first_length) {
    fail(edges.front(), first_length,
         "start_offset " + core::formatNumber(start_offset) + " m lies beyond it");
  }
  if (goal <= (edges.size() == 1 ? start_offset : 0.0)) {
    fail(edges.back(), last_length,
         "end_offset " + core::formatNumber(end_offset) + " m leaves no distance to drive on it");
  }
  return graph.toRoute(path, start_offset, goal);
}

}  // namespace cdiff::map
