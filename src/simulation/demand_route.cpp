// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/demand_route.h"

#include <algorithm>
#include <cmath>

#include "simulation/sumo_conversion.h"

namespace cdiff::simulation {

using map::Lane;
using map::LaneIndex;

namespace {

constexpr double kLaneChangeRoom = 60.0;  ///< needed to reach another lane before a junction [m]
constexpr double kUTurn = 2.6;            ///< a change of heading above this is a turn back [rad]
constexpr double kSmallestGap = 8.0;      ///< to the vehicle ahead and behind [m]
constexpr double kBraking = 3.0;          ///< comfortable [m/s^2]
constexpr double kHeadway = 1.2;          ///< [s]
constexpr double kSideClearance = 0.4;    ///< [m]

/// Distance of a lane to a route, at points every 10 m of the lane.
bool laneNear(const Lane& lane, const geometry::Polyline& path, double radius) {
  constexpr double kSpacing = 10.0;
  for (const Eigen::Vector3d& point : lane.centerline.resampled(kSpacing)) {
    if (path.project(point.head<2>()).distance <= radius) return true;
  }
  return false;
}

/// Gap that a follower needs to a vehicle ahead: a headway, and the way to brake to its speed.
double neededGap(double speed, double speed_ahead) {
  const double braking = (speed * speed - speed_ahead * speed_ahead) / (2.0 * kBraking);
  return kSmallestGap + std::max(0.0, kHeadway * (speed - speed_ahead) + std::max(0.0, braking));
}

}  // namespace

DemandRouter::DemandRouter(const EdgeGraph& graph, const map::Route& ego_route, double radius)
    : graph_(graph) {
  const map::RoadNetwork& network = graph.network();
  for (int edge = 0; edge < static_cast<int>(network.edgeIds().size()); ++edge) {
    const std::vector<LaneIndex>& lanes = graph.lanes(edge);
    near_.push_back(!lanes.empty() &&
                    laneNear(network.lane(lanes.front()), ego_route.path(), radius));
  }
}

std::vector<const EdgeGraph::Link*> DemandRouter::ways(int edge, LaneIndex lane,
                                                       double room) const {
  std::vector<const EdgeGraph::Link*> ways;
  for (const EdgeGraph::Link& link : graph_.links(edge)) {
    const bool reachable = link.from_lane == lane || room >= kLaneChangeRoom;
    if (link.routable && reachable && link.turn < kUTurn) ways.push_back(&link);
  }
  return ways;
}

double DemandRouter::weight(const EdgeGraph::Link& link) const {
  constexpr double kPreferred = 5.0;
  return near_[static_cast<std::size_t>(link.to)] ? kPreferred : 1.0;
}

std::vector<int> DemandRouter::route(LaneIndex lane, double arc_length, double length,
                                     const core::RandomStream& random,
                                     const core::RandomKey& key) const {
  std::vector<int> edges = {graph_.edgeOf(lane)};
  double room = graph_.length(edges.front()) - arc_length;
  double driven = room;
  constexpr std::uint32_t kFirstElement = 16;  // smaller elements of the key belong to the vehicle
  for (std::uint32_t element = kFirstElement; driven < length; ++element) {
    const std::vector<const EdgeGraph::Link*> choices = ways(edges.back(), lane, room);
    if (choices.empty()) break;
    double sum = 0.0;
    for (const EdgeGraph::Link* link : choices) sum += weight(*link);
    double drawn = random.uniform(key, element, 0.0, sum);
    std::size_t chosen = 0;
    while (chosen + 1 < choices.size() && (drawn -= weight(*choices[chosen])) >= 0.0) ++chosen;
    lane = choices[chosen]->to_lane;
    edges.push_back(choices[chosen]->to);
    room = graph_.length(edges.back());
    driven += room;
  }
  return edges;
}

traffic::VehicleState stateAt(const map::RoadNetwork& network, const Insertion& insertion) {
  const geometry::Polyline& line = network.lane(insertion.lane).centerline;
  const Eigen::Vector3d front = line.pointAt(insertion.front);
  traffic::VehicleState state;
  state.heading = line.headingAt(insertion.front);
  state.position = centerBehind(front.head<2>(), state.heading, insertion.dimensions.length);
  state.elevation = front.z();
  state.speed = insertion.speed;
  return state;
}

std::optional<double> freeSpeed(const map::RoadNetwork& network, const Insertion& insertion,
                                const std::vector<traffic::Vehicle>& vehicles) {
  traffic::Vehicle own;
  own.state = stateAt(network, insertion);
  own.dimensions = insertion.dimensions;
  const Lane& lane = network.lane(insertion.lane);
  const double to_end = std::max(0.0, lane.centerline.length() - insertion.front - 1.0);
  double speed = std::min(insertion.speed, std::sqrt(2.0 * kBraking * to_end));
  const double corridor = 0.5 * lane.width;
  for (const traffic::Vehicle& other : vehicles) {
    if (traffic::onDifferentLevels(own, other)) continue;
    geometry::OrientedBox grown = own.box();
    grown.width += 2.0 * kSideClearance;
    grown.length += 2.0 * kSideClearance;
    if (geometry::overlap(grown, other.box())) return std::nullopt;
    const Eigen::Vector2d offset = own.state.pose().toBody(other.state.position);
    const bool same_lane = other.lane_id == lane.id;
    if (!same_lane && std::abs(offset.y()) > corridor + 0.5 * other.dimensions.width) continue;
    const double gap = offset.norm() - 0.5 * (own.dimensions.length + other.dimensions.length);
    const double along = other.state.velocity().dot(geometry::direction(own.state.heading));
    if (gap < kSmallestGap) return std::nullopt;
    if (offset.x() > 0.0) {
      const double other_speed = std::max(0.0, along);
      while (speed > 0.0 && neededGap(speed, other_speed) > gap) speed = std::max(0.0, speed - 0.5);
      if (neededGap(speed, other_speed) > gap) return std::nullopt;
    } else if (along > 0.0 && neededGap(along, speed) > gap) {
      return std::nullopt;
    }
  }
  return speed;
}

}  // namespace cdiff::simulation
