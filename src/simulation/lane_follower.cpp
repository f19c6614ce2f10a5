// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/lane_follower.h"

#include <algorithm>
#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "simulation/sumo_conversion.h"

namespace cdiff::simulation {
namespace {

constexpr geometry::SearchWindow kSearch{15.0, 40.0};  ///< of the route around the last place
constexpr double kLostDistance =
    6.0;  ///< farther from the route than this, the whole route is searched [m]
constexpr double kReachMargin = 0.05;  ///< within SUMO's own limit [m]

}  // namespace

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
    index = progress_edge_ - 1;  // just before the route: goes on with its present edge
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

namespace {

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
