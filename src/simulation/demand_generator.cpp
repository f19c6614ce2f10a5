// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/demand_generator.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulation/sumo_conventions.h"

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

/// Gap that a follower needs to a vehicle ahead: a headway, and the distance to brake to its speed.
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

namespace {

constexpr double kStartSpacing = 15.0;  ///< between places on a lane [m]
constexpr double kStartMargin =
    1.0;  ///< rear bumper to the lane's start, front bumper to its end [m]
constexpr double kOutOfSight = 60.0;    ///< from the ego, once the session runs [m]
constexpr double kRouteLength = 800.0;  ///< [m]
constexpr double kUsualSpeed =
    8.0;  ///< desired at the start, or 0.7 of the limit when that is more [m/s]
constexpr int kTriesPerCall = 12;

constexpr std::array<traffic::VehicleDimensions, 4> kSizes = {
    {{4.2, 1.75, 1.50}, {4.5, 1.80, 1.50}, {4.8, 1.85, 1.45}, {5.2, 1.95, 1.85}}};
constexpr double kLongest = 5.2;

// Elements of one attempt's draws; the router's start at 16.
constexpr std::uint32_t kPlaceElement = 0;
constexpr std::uint32_t kSizeElement = 1;

double fingerprintOf(const std::vector<traffic::Vehicle>& vehicles) {
  double sum = static_cast<double>(vehicles.size());
  for (const traffic::Vehicle& vehicle : vehicles) {
    sum += vehicle.state.position.x() + 3.0 * vehicle.state.position.y();
  }
  return sum;
}

}  // namespace

void DemandOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"density", "", "Vehicles kept alive near the ego."}, density, 0, 1000);
  visitor.number(
      {"radius", "m",
       "Near means within this distance of the ego; vehicles begin within it of the ego route."},
      radius, 20.0, 2000.0);
  visitor.number({"clear_start", "m", "No vehicle begins nearer to the ego's start."}, clear_start,
                 0.0, 1000.0);
  visitor.number({"warm_up", "s", "Traffic is driven this long before the session starts."},
                 warm_up, 0.0, 3600.0);
  visitor.number(
      {"forget_distance", "m", "A generated vehicle farther from the ego leaves the simulation."},
      forget_distance, 50.0, 1e6);
}

DemandGenerator::DemandGenerator(const DemandOptions& options, const map::LaneGraph& graph,
                                 const map::Route& ego_route, std::uint64_t seed)
    : options_(options),
      ego_route_(ego_route),
      random_(seed, "traffic"),
      edges_(graph.network()),
      router_(edges_, ego_route, options.radius) {
  collectStarts();
}

void DemandGenerator::collectStarts() {
  const map::RoadNetwork& network = edges_.network();
  for (map::LaneIndex lane = 0; lane < static_cast<map::LaneIndex>(network.lanes().size());
       ++lane) {
    if (network.lane(lane).routable && !network.lane(lane).internal) addStartsOf(lane);
  }
}

void DemandGenerator::addStartsOf(map::LaneIndex index) {
  const map::Lane& lane = edges_.network().lane(index);
  const Eigen::Vector2d ego_start = ego_route_.path().positionAt(0.0);
  const double last = lane.centerline.length() - kStartMargin;
  for (double front = kLongest + kStartMargin; front <= last; front += kStartSpacing) {
    const Eigen::Vector3d point = lane.centerline.pointAt(front);
    const Eigen::Vector2d position = point.head<2>();
    const Eigen::Vector2d rear =
        position - kLongest * geometry::direction(lane.centerline.headingAt(front));
    const double to_start = std::min((position - ego_start).norm(), (rear - ego_start).norm());
    if (to_start < options_.clear_start + 0.5 * kLongest) continue;
    if (ego_route_.path().project(position).distance > options_.radius) continue;
    starts_.push_back({index, front, position, point.z()});
  }
}

bool DemandGenerator::allowed(const Start& start, const Eigen::Vector2d& ego_position,
                              double ego_elevation, bool warm_up) const {
  const double distance = (start.position - ego_position).norm();
  if (distance > options_.radius - 0.5 * kLongest)
    return false;  // its center counts, half a length behind
  const bool same_level = std::abs(start.elevation - ego_elevation) < traffic::kLevelHeight;
  return warm_up || distance > kOutOfSight || (!same_level && distance > 0.5 * kOutOfSight);
}

std::size_t DemandGenerator::countNear(const std::vector<traffic::Vehicle>& vehicles,
                                       const Eigen::Vector2d& ego_position) const {
  return static_cast<std::size_t>(
      std::count_if(vehicles.begin(), vehicles.end(), [&](const traffic::Vehicle& vehicle) {
        return vehicle.role != traffic::VehicleRole::kEgo &&
               (vehicle.state.position - ego_position).norm() <= options_.radius;
      }));
}

void DemandGenerator::forgetOldCandidates(const std::vector<traffic::Vehicle>& present) {
  const double fingerprint = fingerprintOf(present);
  if (fingerprint != fingerprint_) announced_.clear();
  fingerprint_ = fingerprint;
}

std::optional<DemandVehicle> DemandGenerator::tryStart(
    const Start& start, const std::vector<traffic::Vehicle>& vehicles) {
  const core::RandomKey key{0, draws_, 0};
  const map::Lane& lane = edges_.network().lane(start.lane);
  Insertion insertion;
  insertion.lane = start.lane;
  insertion.front = start.front;
  insertion.dimensions = kSizes[random_.index(key, kSizeElement, kSizes.size())];
  insertion.speed = std::min(lane.speed_limit, std::max(kUsualSpeed, 0.7 * lane.speed_limit));
  const std::optional<double> speed = freeSpeed(edges_.network(), insertion, vehicles);
  if (!speed) return std::nullopt;
  insertion.speed = *speed;
  DemandVehicle vehicle;
  vehicle.id = kGeneratedPrefix + std::to_string(count_++);
  vehicle.edges = edges_.ids(router_.route(start.lane, start.front, kRouteLength, random_, key));
  vehicle.depart_position = start.front;
  vehicle.depart_lane = lane.index;
  vehicle.depart_speed = *speed;
  vehicle.dimensions = insertion.dimensions;
  traffic::Vehicle announced;
  announced.id = vehicle.id;
  announced.state = stateAt(edges_.network(), insertion);
  announced.dimensions = insertion.dimensions;
  announced.lane_id = lane.id;
  announced_.push_back(announced);
  return vehicle;
}

std::optional<DemandVehicle> DemandGenerator::next(const std::vector<traffic::Vehicle>& present,
                                                   const Eigen::Vector2d& ego_position,
                                                   double ego_elevation, bool warm_up) {
  forgetOldCandidates(present);
  std::vector<traffic::Vehicle> vehicles = present;
  vehicles.insert(vehicles.end(), announced_.begin(), announced_.end());
  if (countNear(vehicles, ego_position) < static_cast<std::size_t>(options_.density)) {
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < starts_.size(); ++i) {
      if (allowed(starts_[i], ego_position, ego_elevation, warm_up)) places.push_back(i);
    }
    for (int attempt = 0; attempt < kTriesPerCall && !places.empty(); ++attempt) {
      ++draws_;
      const std::size_t drawn = random_.index({0, draws_, 0}, kPlaceElement, places.size());
      std::optional<DemandVehicle> vehicle = tryStart(starts_[places[drawn]], vehicles);
      if (vehicle) return vehicle;
    }
  }
  announced_.clear();
  return std::nullopt;
}

}  // namespace cdiff::simulation
