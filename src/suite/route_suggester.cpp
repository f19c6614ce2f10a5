// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/route_suggester.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/route_source.h"
#include "simulation/edge_graph.h"
#include "suite/suite_route.h"

namespace cdiff::suite {
namespace {

using core::InputError;
using simulation::EdgeGraph;

constexpr double kLeadIn = 80.0;        ///< driven before the first junction and after the last [m]
constexpr double kEndMargin = 5.0;      ///< left out at both ends of whole edges [m]
constexpr double kFarSearch = 50000.0;  ///< for the way between two edges [m]

/// A tenth of a meter, so that files hold short numbers.
double tenths(double value) { return std::round(10.0 * value) / 10.0; }

/// What a place on a route is worth, and the order of routes that are worth the same.
double worthOf(const SuggestedRoute& route, const map::Route& driven) {
  constexpr double kConflict = 10.0;
  constexpr double kMostConflicts = 5.0;
  constexpr double kLaneChange = 15.0;
  constexpr double kLeft = 5.0;
  constexpr double kWishedLength = 180.0;  // [m]
  return kConflict * std::min(kMostConflicts, static_cast<double>(route.conflicts)) -
         kLaneChange * static_cast<double>(driven.laneChanges().size()) +
         (route.manoeuvre == "left" ? kLeft : 0.0) - 0.1 * std::abs(route.length - kWishedLength);
}

/// Describes routes of one network.
class Suggester {
 public:
  explicit Suggester(const map::LaneGraph& graph) : graph_(graph), edges_(graph.network()) {
    for (int from = 0; from < count(); ++from) {
      for (const EdgeGraph::Link& link : edges_.links(from)) {
        if (usable(link)) before_[link.to].push_back({from, link.turn});
      }
    }
  }

  std::vector<SuggestedRoute> throughJunctions(const RouteEnds& ends) const {
    Paths paths;
    for (int from = 0; from < count(); ++from) {
      if (ends.from.empty() || edges_.id(from) == ends.from) addPaths({from}, paths);
    }
    if (!ends.to.empty()) {
      const int last = edges_.find(ends.to);
      for (auto path = paths.begin(); path != paths.end();)
        path = path->back() == last ? std::next(path) : paths.erase(path);
    }
    return ranked(thinned(paths), ends);
  }

  std::optional<SuggestedRoute> between(const RouteEnds& ends) const {
    std::optional<map::LanePath> best;
    for (const map::LaneIndex from : carLanes(ends.from)) {
      for (const map::LaneIndex to : carLanes(ends.to)) {
        const auto path = graph_.shortestPath({from, 0.0}, {to, lengthOf(to)}, kFarSearch);
        if (path && (!best || path->length < best->length)) best = path;
      }
    }
    if (!best) return std::nullopt;
    std::vector<std::string> edges;
    for (const map::LaneIndex index : best->lanes) {
      const map::Lane& lane = graph_.network().lane(index);
      if (!lane.internal && (edges.empty() || edges.back() != lane.edge_id))
        edges.push_back(lane.edge_id);
    }
    return described(edges, false);
  }

  /// The longest edges that cars may use.
  std::vector<SuggestedRoute> singleEdges() const {
    std::vector<SuggestedRoute> routes;
    for (const std::string& id : graph_.network().edgeIds()) {
      const auto route = carLanes(id).empty() ? std::nullopt : described({id}, false);
      if (route) routes.push_back(*route);
    }
    std::stable_sort(routes.begin(), routes.end(), [](const auto& left, const auto& right) {
      return left.length > right.length;
    });
    return routes;
  }

  std::vector<map::LaneIndex> carLanes(const std::string& edge) const {
    std::vector<map::LaneIndex> lanes;
    for (const map::LaneIndex index : graph_.network().lanesOfEdge(edge)) {
      if (graph_.network().lane(index).routable) lanes.push_back(index);
    }
    return lanes;
  }

 private:
  struct Before {
    int edge = simulation::kNoEdge;
    double turn = 0.0;  ///< [rad]
  };
  using Paths = std::set<std::vector<int>>;
  struct Ranked {
    double worth = 0.0;
    SuggestedRoute route;
  };

  int count() const { return static_cast<int>(graph_.network().edgeIds().size()); }
  double lengthOf(map::LaneIndex lane) const {
    return graph_.network().lane(lane).centerline.length();
  }
  /// No turn round.
  static bool usable(const EdgeGraph::Link& link) {
    constexpr double kMostTurn = 150.0 * core::kDegree;
    return link.routable && link.turn < kMostTurn;
  }

  /// Ways on from a path of edges: through one junction, and on through short edges, as those of a
  /// roundabout are.
  void addPaths(const std::vector<int>& path, Paths& paths) const {
    constexpr double kShortEdge = 50.0;  // [m]
    constexpr std::size_t kLongest = 5;  // edges
    constexpr std::size_t kMostPaths = 20000;
    for (const EdgeGraph::Link& link : edges_.links(path.back())) {
      const bool again = std::find(path.begin(), path.end(), link.to) != path.end();
      if (!usable(link) || again || paths.size() >= kMostPaths) continue;
      std::vector<int> longer = path;
      longer.push_back(link.to);
      paths.insert(longer);
      if (edges_.length(link.to) < kShortEdge && longer.size() < kLongest) addPaths(longer, paths);
    }
  }

  /// At most so many, spread over the network.
  static std::vector<std::vector<int>> thinned(const Paths& all) {
    constexpr std::size_t kMost = 400;
    const std::size_t stride = all.size() / kMost + 1;
    std::vector<std::vector<int>> kept;
    std::size_t number = 0;
    for (const std::vector<int>& path : all) {
      if (number++ % stride == 0) kept.push_back(path);
    }
    return kept;
  }

  std::vector<SuggestedRoute> ranked(const std::vector<std::vector<int>>& paths,
                                     const RouteEnds& ends) const {
    std::vector<Ranked> found;
    std::set<std::vector<std::string>> seen;
    for (std::vector<int> edges : paths) {
      if (ends.from.empty()) extendBack(edges);
      if (ends.to.empty() && edges_.length(edges.back()) < kLeadIn) edges_.extend(edges, kLeadIn);
      const auto route = described(edges_.ids(edges), true);
      if (route && seen.insert(route->edges).second)
        found.push_back({worthOf(*route, driven(*route)), *route});
    }
    std::stable_sort(found.begin(), found.end(), [](const Ranked& left, const Ranked& right) {
      if (left.worth != right.worth) return left.worth > right.worth;
      return left.route.edges < right.route.edges;
    });
    std::vector<SuggestedRoute> routes;
    for (const Ranked& one : found) routes.push_back(one.route);
    return routes;
  }

  /// Edges at the front, straight on where it can, until the approach is long enough.
  void extendBack(std::vector<int>& edges) const {
    double length = edges_.length(edges.front());
    while (length < kLeadIn) {
      const Before* best = nullptr;
      const auto candidates = before_.find(edges.front());
      if (candidates == before_.end()) return;
      for (const Before& before : candidates->second) {
        const bool again = std::find(edges.begin(), edges.end(), before.edge) != edges.end();
        if (!again && (best == nullptr || before.turn < best->turn)) best = &before;
      }
      if (best == nullptr) return;
      edges.insert(edges.begin(), best->edge);
      length += edges_.length(edges.front());
    }
  }

  map::Route driven(const SuggestedRoute& route) const {
    return map::routeAlongEdges(graph_, route.edges, route.start_offset, route.end_offset);
  }

  /// `cut`: leave out what is far from the junctions. nullopt where lanes do not connect or edges
  /// are too short.
  std::optional<SuggestedRoute> described(const std::vector<std::string>& edges, bool cut) const {
    SuggestedRoute route;
    route.edges = edges;
    try {
      route.start_offset = route.end_offset = std::min(kEndMargin, 0.2 * shortestEnd(edges));
      if (cut) cutEnds(driven(route), route);
      const map::Route along = driven(route);
      route.length = tenths(along.length());
      route.conflicts = conflictsAlong(graph_.network(), along);
      route.manoeuvre = manoeuvreAt(turnAlong(along));
      if (route.manoeuvre.empty()) route.manoeuvre = "bends";
      return route;
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  /// Length of the shorter of the first and the last edge [m].
  double shortestEnd(const std::vector<std::string>& edges) const {
    return std::min(edges_.length(edges_.find(edges.front())),
                    edges_.length(edges_.find(edges.back())));
  }

  static void cutEnds(const map::Route& whole, SuggestedRoute& route) {
    const auto& junctions = whole.junctionStretches();
    if (junctions.empty()) return;
    const double first = junctions.front().first;
    const double last = whole.length() - junctions.back().second;
    route.start_offset = tenths(route.start_offset + std::max(0.0, first - kLeadIn));
    route.end_offset = tenths(route.end_offset + std::max(0.0, last - kLeadIn));
  }

  const map::LaneGraph& graph_;
  EdgeGraph edges_;
  std::map<int, std::vector<Before>> before_;
};

void requireEdge(const map::RoadNetwork& network, const std::string& option,
                 const std::string& edge, const Suggester& suggester) {
  if (edge.empty()) return;
  if (network.lanesOfEdge(edge).empty()) {
    throw InputError(option + " '" + core::shortened(edge) +
                     "' is no edge of the network; the nearest name is '" +
                     core::nearestName(edge, network.edgeIds()) + "'");
  }
  if (suggester.carLanes(edge).empty())
    throw InputError(option + " '" + edge + "': no lane of this edge is for cars");
}

/// The best, with no more than a third of one maneuver as long as there are others.
std::vector<SuggestedRoute> mixed(const std::vector<SuggestedRoute>& routes, std::size_t count) {
  const std::size_t share = (count + 2) / 3;
  std::map<std::string, std::size_t> taken;
  std::vector<SuggestedRoute> chosen;
  std::vector<SuggestedRoute> spare;
  for (const SuggestedRoute& route : routes)
    (taken[route.manoeuvre]++ < share ? chosen : spare).push_back(route);
  chosen.insert(chosen.end(), spare.begin(), spare.end());
  if (chosen.size() > count) chosen.resize(count);
  return chosen;
}

std::string endsText(const RouteEnds& ends) {
  return (ends.from.empty() ? "" : " from '" + ends.from + "'") +
         (ends.to.empty() ? "" : " to '" + ends.to + "'");
}

}  // namespace

std::vector<SuggestedRoute> suggestRoutes(const map::LaneGraph& graph, const RouteEnds& ends,
                                          std::size_t count) {
  const map::RoadNetwork& network = graph.network();
  const Suggester suggester(graph);
  requireEdge(network, "--from", ends.from, suggester);
  requireEdge(network, "--to", ends.to, suggester);
  std::vector<SuggestedRoute> routes;
  if (!ends.from.empty() && !ends.to.empty()) {
    if (const auto route = suggester.between(ends)) routes = {*route};
  } else {
    routes = suggester.throughJunctions(ends);
  }
  if (routes.empty() && !endsText(ends).empty()) {
    throw InputError("no way for cars" + endsText(ends) +
                     "; give other edges, or none to see good routes");
  }
  if (routes.empty()) routes = suggester.singleEdges();
  if (routes.empty()) {
    throw InputError("the network has no road for cars: none of its " +
                     std::to_string(network.edgeIds().size()) +
                     " edges has a lane that a passenger car may use at 2 m/s or more");
  }
  return mixed(routes, count);
}

std::string routeText(const SuggestedRoute& route) {
  return route.manoeuvre + ", " + core::formatFixed(route.length, 0) + " m, " +
         std::to_string(route.conflicts) + (route.conflicts == 1 ? " conflict" : " conflicts");
}

}  // namespace cdiff::suite
