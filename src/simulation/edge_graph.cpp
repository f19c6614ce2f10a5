// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/edge_graph.h"

#include <algorithm>
#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "simulation/sumo_conventions.h"

namespace cdiff::simulation {

using map::kNoLane;
using map::Lane;
using map::LaneIndex;

namespace {

constexpr int kLongestChain = 8;  ///< internal lanes in a row; junctions have one to three

/// The first lane outside the junction that a lane leads to.
LaneIndex leaveJunction(const map::RoadNetwork& network, LaneIndex lane) {
  for (int i = 0; i < kLongestChain && network.lane(lane).internal; ++i) {
    if (network.lane(lane).next.empty()) return kNoLane;
    lane = network.lane(lane).next.front().to;
  }
  return network.lane(lane).internal ? kNoLane : lane;
}

/// The last lane before the junction that an internal lane lies in.
LaneIndex beforeJunction(const map::RoadNetwork& network, LaneIndex lane) {
  for (int i = 0; i < kLongestChain && network.lane(lane).internal; ++i) {
    if (network.lane(lane).previous.empty()) return kNoLane;
    lane = network.lane(lane).previous.front();
  }
  return network.lane(lane).internal ? kNoLane : lane;
}

double turnBetween(const Lane& from, const Lane& to) {
  const double before = from.centerline.headingAt(from.centerline.length());
  return std::abs(core::angleDifference(to.centerline.headingAt(0.0), before));
}

constexpr geometry::SearchWindow kSearch{15.0, 40.0};  ///< of the route around the last place
constexpr double kLostDistance =
    6.0;  ///< farther from the route than this, the whole route is searched [m]
constexpr double kReachMargin = 0.05;  ///< within SUMO's own limit [m]

constexpr double kLookAhead = 12.0;  ///< farther than a vehicle drives in a step [m]
constexpr double kPreference = 0.4;  ///< of the lanes ahead over nearer ones [m]
constexpr double kSameDirection = 0.5 * core::kPi;

struct Candidate {
  LaneTarget target;
  double distance = std::numeric_limits<double>::infinity();
};

/// The best place on the lanes that `from` leads to.
Candidate alongLanes(const EdgeGraph& graph, const Eigen::Vector2d& front, double heading,
                     const std::vector<int>& edges, const LanePlace& from) {
  Candidate best;
  double begin = -from.arc_length;  // of the lane, seen from `from`
  map::LaneIndex lane = from.lane;
  while (lane != map::kNoLane && begin < kLookAhead) {
    const geometry::Polyline& line = graph.network().lane(lane).centerline;
    const geometry::Projection here = line.project(front);
    const bool same = std::abs(core::angleDifference(here.heading, heading)) < kSameDirection;
    if (same && here.distance < best.distance - 1e-9) {
      best = {{{lane, here.arc_length}, begin + here.arc_length}, here.distance};
    }
    begin += line.length();
    lane = graph.nextLane(lane, edges);
  }
  return best;
}

}  // namespace

EdgeGraph::EdgeGraph(const map::RoadNetwork& network) : network_(network) {
  for (const std::string& id : network.edgeIds()) {
    edge_by_id_.emplace(id, static_cast<int>(edge_by_id_.size()));
  }
  for (const std::string& id : network.edgeIds()) {
    Edge edge;
    edge.lanes = network.lanesOfEdge(id);
    if (!edge.lanes.empty()) edge.length = network.lane(edge.lanes.front()).centerline.length();
    for (LaneIndex lane : edge.lanes) addLinks(edge, lane);
    edges_.push_back(std::move(edge));
  }
  for (LaneIndex lane = 0; lane < static_cast<LaneIndex>(network.lanes().size()); ++lane) {
    const LaneIndex before = beforeJunction(network, lane);
    edge_of_lane_.push_back(before == kNoLane ? kNoEdge : find(network.lane(before).edge_id));
    const LaneIndex after = leaveJunction(network, lane);
    edge_after_lane_.push_back(after == kNoLane ? kNoEdge : find(network.lane(after).edge_id));
  }
}

void EdgeGraph::addLinks(Edge& edge, LaneIndex from) {
  const Lane& lane = network_.lane(from);
  for (const map::LaneLink& link : lane.next) {
    Link connection;
    connection.from_lane = from;
    connection.to_lane = leaveJunction(network_, link.to);
    if (connection.to_lane == kNoLane) continue;
    const Lane& next = network_.lane(connection.to_lane);
    if (!lane.allows_cars || !next.allows_cars) continue;
    connection.to = find(next.edge_id);
    connection.routable = lane.routable && next.routable;
    connection.turn = turnBetween(lane, next);
    edge.links.push_back(connection);
  }
}

int EdgeGraph::find(const std::string& id) const {
  const auto found = edge_by_id_.find(id);
  return found == edge_by_id_.end() ? kNoEdge : found->second;
}

bool EdgeGraph::connected(int from, int to) const {
  const std::vector<Link>& ways = links(from);
  return std::any_of(ways.begin(), ways.end(), [to](const Link& link) { return link.to == to; });
}

bool EdgeGraph::onRoute(LaneIndex lane, const std::vector<int>& edges) const {
  const int before = edgeOf(lane);
  const int after = edgeAfter(lane);
  const bool inside = network_.lane(lane).internal;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i] != before) continue;
    if (!inside || (i + 1 < edges.size() && edges[i + 1] == after)) return true;
  }
  return false;
}

LaneIndex EdgeGraph::nextLane(LaneIndex lane, const std::vector<int>& edges) const {
  const auto here = std::find(edges.begin(), edges.end(), edgeOf(lane));
  if (here == edges.end() || here + 1 == edges.end()) return kNoLane;
  for (const map::LaneLink& link : network_.lane(lane).next) {
    if (edgeAfter(link.to) == *(here + 1)) return link.to;
  }
  return kNoLane;
}

void EdgeGraph::extend(std::vector<int>& edges, double length) const {
  constexpr std::size_t kAtLeast = 2;
  double added = 0.0;
  for (std::size_t count = 0; added < length || count < kAtLeast; ++count) {
    const Link* best = nullptr;
    for (const Link& link : links(edges.back())) {
      const bool again = std::find(edges.begin(), edges.end(), link.to) != edges.end();
      if (link.routable && !again && (best == nullptr || link.turn < best->turn)) best = &link;
    }
    if (best == nullptr) return;
    edges.push_back(best->to);
    added += this->length(best->to);
  }
}

std::vector<std::string> EdgeGraph::ids(const std::vector<int>& edges) const {
  std::vector<std::string> names;
  names.reserve(edges.size());
  for (int edge : edges) names.push_back(id(edge));
  return names;
}

FrontPlace DrivenRoute::locate(const traffic::VehicleState& state) const {
  constexpr double kWidestHalfLane = 3.0;  // [m]
  FrontPlace place;
  place.position = frontOf(state.pose(), dimensions_.length);
  const double half_width = 0.5 * dimensions_.width;
  const map::RoadNetwork& network = graph_->network();
  for (const map::LaneMatch& match : network.lanesNear(
           place.position, state.elevation, kWidestHalfLane + half_width, state.heading)) {
    const double reach = 0.5 * network.lane(match.lane).width + half_width - kReachMargin;
    if (match.projection.distance < reach) place.lanes.push_back(match);
  }
  return place;
}

bool DrivenRoute::follow(const map::Route* route, const Eigen::Vector2d& front) {
  const double length = route != nullptr ? route->length() : 0.0;
  const bool other = route != route_ || length != route_length_;
  if (other) {
    route_ = route;
    route_length_ = length;
    route_edges_.clear();
    if (route != nullptr) {
      for (const std::string& edge : route->edges()) route_edges_.push_back(graph_->find(edge));
    }
  }
  if (route_edges_.empty()) return other;
  const geometry::Polyline& path = route_->path();
  geometry::Projection here = path.projectNear(front, progress_, kSearch);
  if (other || here.distance > kLostDistance) here = path.project(front);
  progress_ = here.arc_length;
  const std::vector<double>& starts = route_->edgeStarts();
  const auto above = std::upper_bound(starts.begin(), starts.end(), progress_);
  progress_edge_ =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - starts.begin() - 1, 0));
  return other;
}

std::optional<std::size_t> DrivenRoute::routeIndexOf(int current,
                                                     const std::vector<int>& edges) const {
  const std::size_t first = progress_edge_ == 0 ? 0 : progress_edge_ - 1;
  const std::size_t last = std::min(edges.size(), progress_edge_ + 2);
  // The edge of the place comes first, then the one behind, then the one ahead.
  if (progress_edge_ < last && edges[progress_edge_] == current) return progress_edge_;
  for (std::size_t i = first; i < last; ++i) {
    if (edges[i] == current) return i;
  }
  return std::nullopt;
}

std::vector<int> DrivenRoute::edgesFrom(int current, double length) const {
  std::vector<int> edges = {current};
  double ahead = 0.0;
  std::optional<std::size_t> index = routeIndexOf(current, route_edges_);
  if (!index && progress_edge_ < route_edges_.size() &&
      graph_->connected(current, route_edges_[progress_edge_])) {
    index = progress_edge_ - 1;  // just before the route: continues with its current edge
  }
  if (index) {
    for (std::size_t i = *index + 1; i < route_edges_.size(); ++i) {
      if (ahead >= length && i > *index + 2) break;
      if (!graph_->connected(edges.back(), route_edges_[i])) break;
      if (std::find(edges.begin(), edges.end(), route_edges_[i]) != edges.end()) break;
      edges.push_back(route_edges_[i]);
      ahead += graph_->length(edges.back());
    }
  }
  if (ahead < length || edges.size() < 3) graph_->extend(edges, std::max(0.0, length - ahead));
  return edges;
}

int DrivenRoute::startEdge(const FrontPlace& place) const {
  constexpr double kSameDirection = 0.5 * core::kPi;
  for (const map::LaneMatch& match : place.lanes) {
    const int edge = graph_->edgeOf(match.lane);
    if (edge != kNoEdge && routeIndexOf(edge, route_edges_)) return edge;
  }
  for (const map::LaneMatch& match : place.lanes) {
    const int edge = graph_->edgeOf(match.lane);
    if (edge != kNoEdge && std::abs(match.heading_difference) < kSameDirection) return edge;
  }
  return kNoEdge;
}

bool DrivenRoute::onRoute(const FrontPlace& place, const std::vector<int>& edges,
                          double heading_limit) const {
  return std::any_of(place.lanes.begin(), place.lanes.end(), [&](const map::LaneMatch& match) {
    return std::abs(match.heading_difference) <= heading_limit &&
           graph_->onRoute(match.lane, edges);
  });
}

std::optional<LaneTarget> laneTarget(const EdgeGraph& graph, const FrontPlace& front,
                                     double heading, const std::vector<int>& edges,
                                     const LanePlace& from) {
  Candidate best;
  if (from.lane != map::kNoLane) best = alongLanes(graph, front.position, heading, edges, from);
  const double limit = best.distance - kPreference;
  for (const map::LaneMatch& match : front.lanes) {
    if (std::abs(match.heading_difference) >= kSameDirection || !graph.onRoute(match.lane, edges))
      continue;
    if (match.projection.distance >= std::min(limit, best.distance)) continue;
    best = {{{match.lane, match.projection.arc_length}, std::nullopt}, match.projection.distance};
  }
  if (best.target.place.lane == map::kNoLane) return std::nullopt;
  return best.target;
}

}  // namespace cdiff::simulation
