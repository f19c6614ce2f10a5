// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/route_rules.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "planning/route_follower.h"

namespace cdiff::planners {
namespace {

constexpr double kSearchDistance = 80.0;    // of leading and trailing vehicles [m]
constexpr double kLeaderDistance = 2.5;     // of leading vehicles from the route [m]
constexpr double kLaneChangeBehind = 15.0;  // [m]

double lowestLimit(const map::Route& route, double begin, double end) {
  constexpr double kSpacing = 1.0;
  double limit = route.speedLimitAt(end);
  for (double s = begin; s < end; s += kSpacing) limit = std::min(limit, route.speedLimitAt(s));
  return limit;
}

bool changesLaneWithin(const map::Route& route, double begin, double end) {
  const auto& changes = route.laneChanges();
  return std::any_of(changes.begin(), changes.end(),
                     [&](double s) { return s >= begin && s <= end; });
}

/// Near a stretch of the extended route and along its heading there.
bool follows(const map::Route& route, std::pair<double, double> stretch,
             const traffic::VehicleState& vehicle, double max_distance, double max_angle) {
  const double s =
      planning::extendedProjection(route, vehicle.position, stretch.first, stretch.second);
  const double distance = (route.path().extendedPoseAt(s).position - vehicle.position).norm();
  if (distance >= max_distance) return false;
  const double heading = route.path().headingAt(std::clamp(s, 0.0, route.length()));
  return std::abs(core::angleDifference(vehicle.heading, heading)) < max_angle;
}

bool isGreenOrOff(char letter) {
  return letter == 'G' || letter == 'g' || letter == 'o' || letter == 'O';
}

/// Letter of a link, or 'O' (no light) when the snapshot does not know it.
char signalLetter(const traffic::TrafficSnapshot& snapshot, const map::Route::Signal& signal) {
  for (const traffic::SignalState& light : snapshot.signals) {
    if (light.id != signal.id) continue;
    const bool known = signal.link >= 0 && signal.link < static_cast<int>(light.state.size());
    return known ? light.state[static_cast<std::size_t>(signal.link)] : 'O';
  }
  return 'O';
}

}  // namespace

double initialTargetSpeed(const PdmLiteOptions& options, const map::Route& route, double arc_length,
                          double speed, double task_speed) {
  constexpr double kAnticipatedDeceleration = 4.0;
  constexpr double kJunctionDistance = 30.0;
  const double begin = std::clamp(arc_length, 0.0, route.length());
  const double braking = speed * speed / (2.0 * kAnticipatedDeceleration);
  const double limit = lowestLimit(route, begin, std::min(begin + braking, route.length()));
  double target = std::min({options.speed_limit_share * limit, task_speed, limit});
  const double top_speed = options.resolved().top_speed;
  if (top_speed > 0.0) target = std::min(target, top_speed);
  for (const auto& [from, to] : route.junctionStretches()) {
    const bool near = to >= arc_length && from <= arc_length + kJunctionDistance;
    if (near) target = std::min(target, options.junction_speed);
  }
  return target;
}

bool nearLaneChange(const map::Route& route, double arc_length, double speed) {
  const double tens = 3.6 * speed / 10.0;
  const double rest = route.length() - arc_length;
  const double ahead = std::max(20.0, std::min(rest, 0.5 * tens * tens + 10.0));
  return changesLaneWithin(route, arc_length - kLaneChangeBehind, arc_length + ahead);
}

double leaderReach(const map::Route& route, double arc_length,
                   const traffic::VehicleState& vehicle) {
  const Eigen::Vector2d place = route.path().extendedPoseAt(arc_length).position;
  return kSearchDistance + kLeaderDistance + (place - vehicle.position).norm();
}

bool isLeading(const map::Route& route, double arc_length, const traffic::VehicleState& other) {
  const double end = std::max(arc_length, std::min(arc_length + kSearchDistance, route.length()));
  return follows(route, {arc_length, end}, other, kLeaderDistance, core::degreesToRadians(35.0));
}

bool isTrailing(const map::Route& route, double arc_length, const traffic::VehicleState& other) {
  constexpr double kDistance = 3.0;
  constexpr double kDistanceAfterLaneChange = 6.0;
  const bool changed = changesLaneWithin(route, arc_length - kLaneChangeBehind, arc_length);
  return follows(route, {arc_length - kSearchDistance, arc_length}, other,
                 changed ? kDistanceAfterLaneChange : kDistance, core::degreesToRadians(30.0));
}

std::optional<double> distanceToRedLight(const map::Route& route, double arc_length,
                                         const traffic::TrafficSnapshot& snapshot) {
  for (const map::Route::Signal& signal : route.signals()) {
    if (signal.arc_length <= arc_length) continue;
    if (!isGreenOrOff(signalLetter(snapshot, signal))) return signal.arc_length - arc_length;
  }
  return std::nullopt;
}

std::optional<double> StopSignRule::distance(const map::Route& route, double arc_length,
                                             double speed) {
  constexpr double kClearing = 3.0;
  constexpr double kArming = 10.0;
  constexpr double kStanding = 0.1;
  const std::vector<double>& signs = route.stopSigns();
  const auto next = std::upper_bound(signs.begin(), signs.end(), arc_length);
  if (next == signs.end()) return std::nullopt;
  const double distance = *next - arc_length;
  if (distance > kArming) cleared_ = false;
  if (distance < kClearing && speed < kStanding) cleared_ = true;
  return cleared_ ? std::nullopt : std::optional<double>(distance);
}

bool isBicycle(const traffic::VehicleDimensions& dimensions) {
  constexpr double kWidest = 0.75;
  return dimensions.width <= kWidest;
}

namespace {

/// PDM-Lite's constants, or those of a vehicle with an even style.
IdmParameters parametersOf(const DrivingStyle& style) {
  IdmParameters parameters;
  if (!style.even()) return parameters;
  parameters.acceleration = style.acceleration;
  parameters.slow_deceleration = style.deceleration;
  parameters.fast_deceleration = style.deceleration;
  return parameters;
}

/// What IDM is to desire behind something. An even vehicle that is too fast slows down for that by
/// freeSpeed alone, because IDM's own term is unbounded.
double desiredBehind(const DrivingStyle& style, double speed, double desired) {
  return style.even() ? std::max(desired, speed) : desired;
}

}  // namespace

double freeSpeed(const DrivingStyle& style, double speed, double desired) {
  if (!style.even()) return desired;
  const IdmParameters parameters = parametersOf(style);
  IdmObstacle none;
  none.distance = 1e9;
  return std::max(idmSpeed(speed, desired, none, parameters),
                  speed - style.deceleration * parameters.time_bound);
}

double idmBehind(const DrivingStyle& style, const traffic::Vehicle& self,
                 const traffic::Vehicle& leader, double desired) {
  const double speed = self.state.speed;
  IdmObstacle obstacle;
  obstacle.minimum_gap = style.minimum_gap;
  obstacle.time_headway = style.time_headway;
  obstacle.distance = (leader.state.position - self.state.position).norm();
  obstacle.speed = leader.state.speed;
  obstacle.length = leader.dimensions.length;
  return idmBehind(style, obstacle, speed, desired);
}

double idmBehind(const DrivingStyle& style, const IdmObstacle& obstacle, double speed,
                 double desired) {
  return idmSpeed(speed, desiredBehind(style, speed, desired), obstacle, parametersOf(style));
}

StopLine lineOfLight(double distance) { return {distance, 6.0, 0.1}; }

StopLine lineOfStopSign(double distance) { return {distance, 2.0, 0.1}; }

double idmBefore(const StopLine& line, const DrivingStyle& style, double speed, double desired) {
  IdmObstacle obstacle;
  obstacle.distance = line.distance;
  obstacle.minimum_gap = line.minimum_gap;
  obstacle.time_headway = line.time_headway;
  return idmBehind(style, obstacle, speed, desired);
}

}  // namespace cdiff::planners
