// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/wait_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cdiff::record {
namespace {

using traffic::Vehicle;

constexpr double kAhead = 20.0;        ///< from the front bumper to an obstacle [m]
constexpr double kToLine = 15.0;       ///< from the front bumper to the junction it waits at [m]
constexpr double kToEntry = 25.0;      ///< of another vehicle from the same junction [m]
constexpr double kSideRoom = 0.4;      ///< beside the ego's box that others must leave free [m]
constexpr double kWaitingSpeed = 0.5;  ///< slower is waiting [m/s]

/// A vehicle and how far it is.
struct Nearest {
  const Vehicle* vehicle = nullptr;
  double distance = std::numeric_limits<double>::infinity();

  /// The first of equals stays.
  void take(const Vehicle& other, double other_distance) {
    const bool tie = vehicle != nullptr && other_distance == distance && other.id < vehicle->id;
    if (other_distance < distance || tie) *this = {&other, other_distance};
  }
};

Eigen::Vector2d frontOf(const Vehicle& vehicle) {
  return vehicle.state.position +
         0.5 * vehicle.dimensions.length * geometry::direction(vehicle.state.heading);
}

std::vector<Eigen::Vector2d> outlineOf(const Vehicle& vehicle) {
  const Eigen::Vector2d along = geometry::direction(vehicle.state.heading);
  const Eigen::Vector2d across(-along.y(), along.x());
  std::vector<Eigen::Vector2d> points;
  for (const double forward : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
    for (const double left : {-0.5, 0.5}) {
      points.push_back(vehicle.state.position + forward * vehicle.dimensions.length * along +
                       left * vehicle.dimensions.width * across);
    }
  }
  return points;
}

/// Finds what one vehicle after the other waits for in one snapshot.
class WaitSearch {
 public:
  WaitSearch(const traffic::TrafficSnapshot& snapshot, const map::RoadNetwork& network)
      : snapshot_(snapshot), network_(network) {}

  Wait ofEgo(const Vehicle& ego, const map::Route& route) const {
    const geometry::Polyline& path = route.path();
    const double front = path.project(frontOf(ego)).arc_length;
    if (const Vehicle* leader = onRoute(ego, route, front)) return behind(ego, *leader, "");
    for (const map::Route::Signal& signal : route.signals()) {
      const double ahead = signal.arc_length - front;
      if (ahead < -1.0 || ahead > kToLine || isGreen(signal.id, signal.link)) continue;
      return {ego.id, Wait::For::kLight, signal.id, junctionAhead(route, signal.arc_length)};
    }
    const std::string junction = junctionAhead(route, front);
    if (const Vehicle* other = inJunction(ego, junction)) return behind(ego, *other, junction);
    for (const double line : route.stopSigns()) {
      if (line - front > -1.0 && line - front < kToLine)
        return {ego.id, Wait::For::kStopLine, "", junction};
    }
    return {ego.id, Wait::For::kNothing, "", junction};
  }

  Wait of(const Vehicle& vehicle) const {
    const map::LaneIndex index = laneOf(vehicle);
    if (index == map::kNoLane) return {vehicle.id, Wait::For::kNothing, "", ""};
    const map::Lane& lane = network_.lane(index);
    const double front = lane.centerline.project(frontOf(vehicle)).arc_length;
    const double to_line = lane.centerline.length() - front;
    Nearest leader;
    followLanes(vehicle, index, -front, leader);
    const bool at_line = !lane.internal && to_line < kToLine && !lane.next.empty();
    const bool queue = leader.vehicle != nullptr &&
                       (lane.internal || !at_line || laneOf(*leader.vehicle) == index);
    if (queue) return behind(vehicle, *leader.vehicle, lane.internal ? lane.junction_id : "");
    if (!lane.internal && !at_line) return {vehicle.id, Wait::For::kNothing, "", ""};
    const std::string red = at_line ? redLight(lane) : "";
    if (!red.empty()) return {vehicle.id, Wait::For::kLight, red, lane.junction_id};
    if (leader.vehicle != nullptr) return behind(vehicle, *leader.vehicle, lane.junction_id);
    if (const Vehicle* other = inJunction(vehicle, lane.junction_id))
      return behind(vehicle, *other, lane.junction_id);
    return {vehicle.id, Wait::For::kNothing, "", lane.junction_id};
  }

 private:
  static Wait behind(const Vehicle& vehicle, const Vehicle& obstacle, const std::string& junction) {
    return {vehicle.id, Wait::For::kVehicle, obstacle.id, junction};
  }

  /// The nearest vehicle whose outline lies in the way of the ego's box along its route.
  const Vehicle* onRoute(const Vehicle& ego, const map::Route& route, double front) const {
    const double side = 0.5 * ego.dimensions.width + kSideRoom;
    Nearest nearest;
    for (const Vehicle& other : snapshot_.vehicles) {
      const double reach = kAhead + ego.dimensions.length + other.dimensions.length;
      const bool far = (other.state.position - ego.state.position).norm() > reach;
      if (other.id == ego.id || far || traffic::onDifferentLevels(ego, other)) continue;
      for (const Eigen::Vector2d& point : outlineOf(other)) {
        const WayPlace place = placeOnWay(route.path(), point, front);
        const bool ahead = place.ahead > 1e-6 || inFront(ego, point);
        if (ahead && place.ahead < kAhead && place.beside < side) nearest.take(other, place.ahead);
      }
    }
    return nearest.vehicle;
  }

  /// A point relative to a way that goes straight on beyond its end.
  struct WayPlace {
    double ahead = 0.0;   ///< along the way from `front` [m]
    double beside = 0.0;  ///< distance from the way [m]
  };
  static WayPlace placeOnWay(const geometry::Polyline& path, const Eigen::Vector2d& point,
                             double front) {
    const auto place = path.project(point, front, front + kAhead);
    const geometry::Pose2d end = path.extendedPoseAt(path.length());
    const Eigen::Vector2d beyond = end.toBody(point);
    if (path.length() - front > kAhead || beyond.x() <= 0.0)
      return {place.arc_length - front, place.distance};
    return {path.length() - front + beyond.x(), std::abs(beyond.y())};
  }

  static bool inFront(const Vehicle& vehicle, const Eigen::Vector2d& point) {
    return vehicle.state.pose().toBody(point).x() > 0.5 * vehicle.dimensions.length;
  }

  bool isGreen(const std::string& light, int link) const {
    for (const traffic::SignalState& signal : snapshot_.signals) {
      if (signal.id != light) continue;
      if (link < 0 || static_cast<std::size_t>(link) >= signal.state.size()) return true;
      const char letter = signal.state[static_cast<std::size_t>(link)];
      return letter != 'r' && letter != 'u' && letter != 'y';
    }
    return true;
  }

  /// The light that is green for no link of the lane; empty where there is none.
  std::string redLight(const map::Lane& lane) const {
    std::string red;
    for (const map::LaneLink& link : lane.next) {
      if (link.signal_id.empty() || isGreen(link.signal_id, link.signal_link)) return "";
      red = link.signal_id;
    }
    return red;
  }

  /// The junction at an arc length; empty outside.
  std::string junctionAt(const map::Route& route, double arc_length) const {
    const map::Lane& lane = network_.lane(route.laneAt(std::min(arc_length, route.length())));
    return lane.internal ? lane.junction_id : "";
  }

  /// The junction that the front is in or within kToLine of.
  std::string junctionAhead(const map::Route& route, double front) const {
    for (const auto& [begin, end] : route.junctionStretches()) {
      if (front < end && begin - front < kToLine)
        return junctionAt(route, std::max(begin, front) + 0.5 * std::min(1.0, end - begin));
    }
    return "";
  }

  map::LaneIndex laneOf(const Vehicle& vehicle) const {
    return vehicle.lane_id.empty() ? map::kNoLane : network_.findLane(vehicle.lane_id);
  }

  /// The nearest vehicle on a lane whose start lies `begin` ahead of the front, and on those after
  /// it.
  void followLanes(const Vehicle& vehicle, map::LaneIndex index, double begin,
                   Nearest& nearest) const {
    const map::Lane& lane = network_.lane(index);
    for (const Vehicle& other : snapshot_.vehicles) {
      if (other.id == vehicle.id || laneOf(other) != index) continue;
      const double gap = begin + lane.centerline.project(other.state.position).arc_length;
      if (gap > 0.0 && gap < kAhead) nearest.take(other, gap);
    }
    const double end = begin + lane.centerline.length();
    if (end > kAhead || nearest.distance < end) return;
    for (const map::LaneLink& link : lane.next) followLanes(vehicle, link.to, end, nearest);
  }

  /// The vehicle that a vehicle at or in a junction most likely lets pass: the nearest in the
  /// junction, else the nearest at another of its entries.
  const Vehicle* inJunction(const Vehicle& vehicle, const std::string& junction) const {
    if (junction.empty()) return nullptr;
    const map::LaneIndex own = laneOf(vehicle);
    const Eigen::Vector2d front = frontOf(vehicle);
    Nearest inside;
    Nearest entering;
    for (const Vehicle& other : snapshot_.vehicles) {
      const map::LaneIndex index = laneOf(other);
      if (other.id == vehicle.id || index == map::kNoLane) continue;
      const map::Lane& lane = network_.lane(index);
      if (lane.junction_id != junction) continue;
      const double distance = (other.state.position - front).norm();
      if (lane.internal) {
        inside.take(other, distance);
      } else if (own == map::kNoLane || lane.edge_id != network_.lane(own).edge_id) {
        const auto place = lane.centerline.project(frontOf(other));
        if (lane.centerline.length() - place.arc_length < kToEntry) entering.take(other, distance);
      }
    }
    return inside.vehicle != nullptr ? inside.vehicle : entering.vehicle;
  }

  const traffic::TrafficSnapshot& snapshot_;
  const map::RoadNetwork& network_;
};

}  // namespace

std::vector<std::string> WaitChain::queue() const {
  std::vector<std::string> vehicles;
  for (const Wait& wait : waits) {
    if (wait.reason != Wait::For::kVehicle || !wait.junction.empty()) break;
    vehicles.push_back(wait.obstacle);
  }
  return vehicles;
}

WaitChain waitChain(const traffic::TrafficSnapshot& snapshot, const map::RoadNetwork& network,
                    const map::Route& ego_route) {
  WaitChain chain;
  const Vehicle* vehicle = snapshot.ego();
  if (vehicle == nullptr || ego_route.empty()) return chain;
  const WaitSearch search(snapshot, network);
  chain.waits.push_back(search.ofEgo(*vehicle, ego_route));
  while (chain.waits.back().reason == Wait::For::kVehicle) {
    const std::string next = chain.waits.back().obstacle;
    const auto& waits = chain.waits;
    chain.ring = std::any_of(waits.begin(), waits.end(),
                             [&](const Wait& wait) { return wait.vehicle == next; });
    vehicle = snapshot.find(next);
    if (chain.ring || vehicle == nullptr || vehicle->state.speed > kWaitingSpeed) break;
    chain.waits.push_back(search.of(*vehicle));
  }
  return chain;
}

}  // namespace cdiff::record
