// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/lane_traffic.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::simulation {
namespace {

constexpr double kSpeedSpread = 0.15;            // of drivers' speeds, below and above the limit
constexpr double kMostOffset = 2.0;              // [m] from the route, at most
constexpr double kMostTurned = core::kPi / 6.0;  // from the route's, at most
constexpr double kSettlingTime = 0.8;            // [s] of what is off the route after a release
constexpr double kRouteMargin = 1.0;             // [m] before the end of a route, where one leaves
constexpr std::uint64_t kStepsPerThought = 2;    // of the drivers: 0.1 s
constexpr int kLongestJunction = 8;              // internal lanes in a row

using map::LaneIndex;

/// The internal lanes from `lane` to a lane of `edge`, that lane last; empty where there is none.
std::vector<LaneIndex> linkTo(const map::RoadNetwork& network, LaneIndex lane,
                              const std::string& edge) {
  for (const map::LaneLink& link : network.lane(lane).next) {
    std::vector<LaneIndex> lanes = {link.to};
    for (int i = 0; i < kLongestJunction && network.lane(lanes.back()).internal; ++i) {
      if (network.lane(lanes.back()).next.empty()) break;
      lanes.push_back(network.lane(lanes.back()).next.front().to);
    }
    if (network.lane(lanes.back()).edge_id == edge) return lanes;
  }
  return {};
}

/// The same with changes to neighboring lanes first, the fewest that will do.
std::vector<LaneIndex> pathTo(const map::RoadNetwork& network, LaneIndex lane,
                              const std::string& edge) {
  std::vector<LaneIndex> path = linkTo(network, lane, edge);
  std::vector<LaneIndex> left;
  std::vector<LaneIndex> right;
  LaneIndex to_left = lane;
  LaneIndex to_right = lane;
  while (path.empty() && (to_left != map::kNoLane || to_right != map::kNoLane)) {
    for (const bool leftwards : {true, false}) {
      LaneIndex& side = leftwards ? to_left : to_right;
      if (side == map::kNoLane || !path.empty()) continue;
      side = leftwards ? network.lane(side).left : network.lane(side).right;
      if (side == map::kNoLane || !network.lane(side).allows_cars) continue;
      std::vector<LaneIndex>& changes = leftwards ? left : right;
      changes.push_back(side);
      const std::vector<LaneIndex> link = linkTo(network, side, edge);
      if (link.empty()) continue;
      path = changes;
      path.insert(path.end(), link.begin(), link.end());
    }
  }
  return path;
}

}  // namespace

LaneTraffic::LaneTraffic(const map::LaneGraph& graph, double step,
                         const LaneTrafficOptions& options)
    : graph_(graph), step_(step), options_(options) {}

LaneTraffic::~LaneTraffic() = default;

LaneTraffic::Car& LaneTraffic::carOf(const std::string& id) {
  const auto found = cars_.find(id);
  if (found == cars_.end())
    throw core::SimulatorError("lane traffic: there is no vehicle '" + id + "'");
  return *found->second;
}

void LaneTraffic::addDriven(const std::string& id, const traffic::VehicleDimensions& dimensions,
                            const DrivenVehicle& start) {
  auto car = std::make_unique<Car>();
  car->state.id = id;
  car->state.state = start.state;
  car->state.dimensions = dimensions;
  car->ours = true;
  cars_[id] = std::move(car);
}

void LaneTraffic::takeOver(const std::string& id) { carOf(id).ours = true; }

bool LaneTraffic::release(const DrivenVehicle& vehicle) {
  Car& car = carOf(vehicle.id);
  if (vehicle.route == nullptr || vehicle.route->empty()) {
    remove(vehicle.id);
    return false;
  }
  const geometry::Projection nearest = vehicle.route->path().project(vehicle.state.position);
  const double turned = core::angleDifference(vehicle.state.heading, nearest.heading);
  if (nearest.distance > kMostOffset || std::abs(turned) > kMostTurned) {
    remove(vehicle.id);
    return false;
  }
  car.route = *vehicle.route;
  car.place = nearest.arc_length;
  car.offset = nearest.lateral_offset;
  car.turned = turned;
  car.ours = false;
  return true;
}

map::LanePath LaneTraffic::lanesAlong(const std::vector<std::string>& edges, int lane,
                                      double arc_length) const {
  const map::RoadNetwork& network = graph_.network();
  const std::vector<LaneIndex> first =
      edges.empty() ? std::vector<LaneIndex>() : network.lanesOfEdge(edges.front());
  if (lane < 0 || lane >= static_cast<int>(first.size())) return {};
  map::LanePath path{{first[static_cast<std::size_t>(lane)]}, -arc_length};
  path.length += network.lane(path.lanes.back()).centerline.length();
  for (std::size_t i = 1; i < edges.size() && path.length < options_.route_length; ++i) {
    const std::vector<LaneIndex> next = pathTo(network, path.lanes.back(), edges[i]);
    if (next.empty()) break;
    for (const LaneIndex index : next) {
      const bool beside = network.lane(index).edge_id == network.lane(path.lanes.back()).edge_id &&
                          !network.lane(index).internal;
      if (!beside) path.length += network.lane(index).centerline.length();
      path.lanes.push_back(index);
    }
  }
  return path;
}

bool LaneTraffic::addBackground(const std::string& id, const std::vector<std::string>& edges,
                                double depart_position, int depart_lane, double depart_speed,
                                const traffic::VehicleDimensions& dimensions) {
  const double center = depart_position - 0.5 * dimensions.length;
  const map::LanePath path = lanesAlong(edges, depart_lane, center);
  if (path.lanes.empty() || center < 0.0 || path.length < dimensions.length) return false;
  auto car = std::make_unique<Car>();
  const double end = graph_.network().lane(path.lanes.back()).centerline.length();
  car->route = graph_.toRoute(path, center, end);
  car->state.id = id;
  car->state.dimensions = dimensions;
  car->state.state.speed = depart_speed;
  const core::RandomStream drivers(0, "lane traffic drivers");
  car->limit_share = 1.0 + drivers.uniform({core::hashText(id)}, 0, -kSpeedSpread, kSpeedSpread);
  place(*car);
  cars_[id] = std::move(car);
  return true;
}

void LaneTraffic::remove(const std::string& id) {
  if (cars_.erase(id) != 0 || findVehicle(reported_, id) != nullptr) return;
  throw core::SimulatorError("lane traffic: there is no vehicle '" + id + "' to remove");
}

/// State of a car where its route has it.
void LaneTraffic::place(Car& car) const {
  const Eigen::Vector3d point = car.route.path().pointAt(car.place);
  const double heading = car.route.path().headingAt(car.place);
  traffic::VehicleState& state = car.state.state;
  state.position =
      point.head<2>() + car.offset * geometry::leftNormal(geometry::direction(heading));
  state.heading = core::wrapAngle(heading + car.turned);
  state.elevation = point.z();
  const LaneIndex lane = car.route.laneAt(car.place);
  if (lane == car.lane) return;
  car.lane = lane;
  car.state.lane_id = graph_.network().lane(lane).id;
}

void LaneTraffic::move(Car& car) const {
  double& speed = car.state.state.speed;
  const double before = speed;
  speed = std::max(0.0, speed + car.state.acceleration * step_);
  car.place += 0.5 * (before + speed) * step_;
  const double kept = 1.0 - step_ / kSettlingTime;
  car.offset *= kept;
  car.turned *= kept;
  place(car);
}

void LaneTraffic::step(const std::vector<DrivenVehicle>& driven) {
  if (steps_++ % kStepsPerThought == 0) {
    for (auto& [id, car] : cars_) {
      if (!car->ours) car->state.acceleration = accelerationOf(*car);
    }
  }
  for (const DrivenVehicle& vehicle : driven) carOf(vehicle.id).state.state = vehicle.state;
  reported_.clear();
  for (auto car = cars_.begin(); car != cars_.end();) {
    if (!car->second->ours) move(*car->second);
    const bool leaves =
        !car->second->ours && car->second->place > car->second->route.length() - kRouteMargin;
    if (!leaves) reported_.push_back(car->second->state);
    car = leaves ? cars_.erase(car) : std::next(car);
  }
}

namespace {

constexpr double kClearanceBeside = 0.2;  // [m] beside what is driven past
constexpr double kMeetingRadius = 2.4;    // [m] around a path, in which others are met
constexpr double kStopBefore = 4.0;       // [m] before a place where others are met
constexpr double kGoesFirst = 1.5;        // [s] before one of ours: then it need not yield
constexpr double kAcross = 0.6;           // [rad] between headings of paths that cross
constexpr double kLeastGap = 0.1;         // [m]

}  // namespace

traffic::VehicleState LaneTraffic::ahead(const Car& car, double time) {
  traffic::VehicleState state = car.state.state;
  if (car.ours) {
    state.position += time * state.velocity();
  } else {
    const double place = car.place + time * state.speed;
    state.position = car.route.path().positionAt(place);
    state.heading = car.route.path().headingAt(place);
  }
  return state;
}

double LaneTraffic::accelerationBehind(const Car& car, const Obstacle& obstacle) const {
  const double v = car.state.state.speed;
  const double root = 2.0 * std::sqrt(options_.acceleration * options_.deceleration);
  const double wanted = options_.minimum_gap +
                        std::max(0.0, v * options_.time_headway + v * (v - obstacle.speed) / root);
  const double ratio = wanted / std::max(obstacle.gap, kLeastGap);
  return options_.acceleration * ratio * ratio;
}

double LaneTraffic::accelerationOf(const Car& car) const {
  constexpr double kLimitAhead = 12.0;  // [m] that a lower limit is seen from
  const double v = car.state.state.speed;
  const double limit =
      std::min(car.route.speedLimitAt(car.place),
               car.route.speedLimitAt(std::min(car.front() + kLimitAhead, car.route.length())));
  const double ratio = v / std::max(1.0, car.limit_share * limit);
  const double look_ahead = 15.0 + 1.5 * v + v * v / (2.0 * options_.deceleration);
  double strongest = 0.0;
  for (const auto& [id, other] : cars_) {
    if (other.get() == &car) continue;
    const traffic::VehicleState& state = other->state.state;
    const double reach = look_ahead + 2.0 * state.speed;
    if ((state.position - car.state.state.position).squaredNorm() > reach * reach ||
        traffic::onDifferentLevels(state.elevation, car.state.state.elevation))
      continue;
    Obstacle obstacle;
    if (onPath(car, *other, look_ahead, obstacle) || crossesPath(car, *other, look_ahead, obstacle))
      strongest = std::max(strongest, accelerationBehind(car, obstacle));
  }
  const double free = options_.acceleration * (1.0 - ratio * ratio * ratio * ratio);
  return std::max(-options_.hardest_deceleration,
                  std::max(free, -options_.deceleration) - strongest);
}

/// Whether the other stands or drives on the car's path now.
bool LaneTraffic::onPath(const Car& car, const Car& other, double look_ahead,
                         Obstacle& obstacle) const {
  const geometry::Polyline& path = car.route.path();
  const traffic::VehicleState& state = other.state.state;
  const geometry::Projection nearest =
      path.project(state.position, car.place, car.place + look_ahead);
  if (nearest.arc_length <= car.place) return false;
  const Eigen::Vector2d along = geometry::direction(nearest.heading);
  const double beside = 0.5 * car.state.dimensions.width + kClearanceBeside +
                        geometry::halfExtent(other.box(), geometry::leftNormal(along));
  if (nearest.distance >= beside) return false;
  const double turned = core::angleDifference(state.heading, nearest.heading);
  obstacle.gap = nearest.arc_length - car.front() - geometry::halfExtent(other.box(), along);
  obstacle.speed = std::max(0.0, state.speed * std::cos(turned));
  const bool stuck = !other.ours && std::abs(turned) > kAcross && obstacle.gap < kStopBefore &&
                     car.state.id < other.state.id;
  return !stuck;
}

/// Whether the other will soon be on the car's path, and goes first.
bool LaneTraffic::crossesPath(const Car& car, const Car& other, double look_ahead,
                              Obstacle& obstacle) const {
  constexpr double kTimes[] = {1.0, 2.0};  // [s]
  constexpr double kMoving = 1.0;          // [m/s]
  if (other.state.state.speed < kMoving) return false;
  for (const double time : kTimes) {
    const traffic::VehicleState then = ahead(other, time);
    const geometry::Projection nearest =
        car.route.path().project(then.position, car.place, car.place + look_ahead);
    if (nearest.arc_length <= car.place || nearest.distance > kMeetingRadius) continue;
    const double to_meeting = nearest.arc_length - car.front();
    const double arrival = to_meeting / std::max(car.state.state.speed, kMoving);
    const bool yields =
        other.ours ? arrival > time - kGoesFirst
                   : std::make_pair(time, other.state.id) < std::make_pair(arrival, car.state.id);
    if (!yields || to_meeting < kStopBefore) continue;
    obstacle = {to_meeting - kStopBefore, 0.0};
    return true;
  }
  return false;
}

}  // namespace cdiff::simulation
