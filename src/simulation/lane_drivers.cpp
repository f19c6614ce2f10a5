// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cmath>
#include <utility>

#include "e2e_cdiff/core/angle.h"
#include "simulation/lane_traffic.h"

namespace cdiff::simulation {
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
