// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/driven_fleet.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "simulation/sumo_conventions.h"

namespace cdiff::simulation {
namespace {

constexpr double kGivenRouteLength = 250.0;  ///< set ahead of the current edge [m]
constexpr double kRouteRefresh = 100.0;      ///< a new route is set when less is left [m]
constexpr double kFarOff = 3.0;              ///< SUMO's vehicle is put to its place beyond this [m]
constexpr double kCatchUp = 4.0;             ///< share of the distance made up per second [1/s]
constexpr double kCatchUpSpeed = 2.0;        ///< at most [m/s]
constexpr double kStanding = 0.05;           ///< [m/s]
constexpr int kKeepRouteExact = 3;           ///< keep the route, at the exact place
constexpr int kAnywhere = 2;                 ///< at the exact place, whatever lane is there

/// Whether one list of edges starts with the other.
bool agree(const std::vector<int>& first, const std::vector<int>& second) {
  const auto common = static_cast<std::ptrdiff_t>(std::min(first.size(), second.size()));
  return std::equal(first.begin(), first.begin() + common, second.begin());
}

/// The edges from the first `current` on; empty when it is not among them.
std::vector<int> restOf(const std::vector<int>& edges, int current) {
  return {std::find(edges.begin(), edges.end(), current), edges.end()};
}

/// Speed that brings SUMO's vehicle `ahead` meters on in this step, nearly: a difference to the
/// vehicle's own speed is made up smoothly, because followers react to it.
double commandedSpeed(double speed, double ahead, double step) {
  const double behind = ahead - speed * step;
  if (speed < kStanding && std::abs(behind) < 0.3) return 0.0;
  return std::max(0.0, speed + std::clamp(kCatchUp * behind, -kCatchUpSpeed, kCatchUpSpeed));
}

}  // namespace

void DrivenFleet::setModes(const std::string& id, int speed_mode) {
  calls_.setSpeedMode(id, speed_mode);
  calls_.setLaneChangeMode(id, kLaneChangeModeOff);
}

int DrivenFleet::edgeOf(const std::string& lane_id) const {
  if (lane_id.empty()) return kNoEdge;
  const map::LaneIndex lane = graph_.network().findLane(lane_id);
  return lane == map::kNoLane ? kNoEdge : graph_.edgeOf(lane);
}

double DrivenFleet::sumoScale(map::LaneIndex index) {
  const auto known = scales_.find(index);
  if (known != scales_.end()) return known->second;
  const map::Lane& lane = graph_.network().lane(index);
  const double scale = calls_.laneLength(lane.id) / lane.centerline.length();
  return scales_.emplace(index, scale).first->second;
}

void DrivenFleet::add(const DrivenVehicle& start, const traffic::VehicleDimensions& dimensions,
                      const std::string& type_id) {
  Moved moved(DrivenRoute(graph_, dimensions));
  const FrontPlace place = moved.route.locate(start.state);
  moved.route.follow(start.route, place.position);
  int edge = moved.route.startEdge(place);
  moved.on_route = edge != kNoEdge;
  for (const map::LaneMatch& match : graph_.network().lanesNear(place.position, 200.0)) {
    if (edge == kNoEdge) edge = graph_.edgeOf(match.lane);
  }
  if (edge == kNoEdge) {
    throw core::InputError(
        "vehicle '" + start.id + "' starts at (" + core::formatNumber(start.state.position.x()) +
        ", " + core::formatNumber(start.state.position.y()) + "), 200 m from every road");
  }
  moved.given = moved.route.edgesFrom(edge, kGivenRouteLength);
  const std::string route_id = "driven_" + std::to_string(added_++) + "_" + start.id;
  calls_.addRoute(route_id, graph_.ids(moved.given));
  calls_.addVehicle(start.id, route_id, type_id, {});
  setModes(start.id, kSpeedModeOff);
  forget(start.id);
  vehicles_.emplace(start.id, std::move(moved));
}

void DrivenFleet::forget(const std::string& id) {
  vehicles_.erase(id);
  released_.erase(id);
}

bool DrivenFleet::setRoute(const std::string& id, Moved& moved, const std::vector<int>& edges) {
  if (!link_.attempt([&] { calls_.setRoute(id, graph_.ids(edges)); })) return false;
  moved.given = edges;
  return true;
}

void DrivenFleet::leaveRoute(Moved& moved) {
  moved.on_route = false;
  moved.refused_lane.clear();
}

void DrivenFleet::updateRoute(const std::string& id, Moved& moved, const FrontPlace& place) {
  if (moved.on_route && !moved.route.onRoute(place, moved.given, core::kPi)) leaveRoute(moved);
  const int current = edgeOf(moved.lane_id);
  if (current == kNoEdge) return;
  const std::vector<int> rest = restOf(moved.given, current);
  if (moved.on_route && rest.empty()) leaveRoute(moved);  // SUMO placed it on another road
  double left = 0.0;
  for (std::size_t i = 1; i < rest.size(); ++i) left += graph_.length(rest[i]);
  const bool enough = left >= kRouteRefresh && rest.size() >= 3;
  if (current != moved.last_edge) moved.outdated = true;
  moved.last_edge = current;
  if (moved.on_route && enough && !moved.outdated) return;
  if (moved.refused_lane == moved.lane_id) return;
  const std::vector<int> edges = moved.route.edgesFrom(current, kGivenRouteLength);
  const bool same = moved.on_route && (edges == rest || (enough && agree(edges, rest)));
  if (!same) {
    if (!moved.route.onRoute(place, edges, 0.5 * core::kPi)) return;
    if (!setRoute(id, moved, edges)) {
      moved.refused_lane = moved.lane_id;
      return;
    }
    moved.on_route = true;
  }
  moved.outdated = false;
  moved.refused_lane = same ? moved.lane_id : "";
}

double DrivenFleet::usableLength(map::LaneIndex lane, const Moved& moved) const {
  constexpr double kBeforeTheEnd =
      1.0;  // [m] at the very end of its route SUMO takes a vehicle out
  const double length = graph_.network().lane(lane).centerline.length();
  const bool last = graph_.edgeAfter(lane) == moved.given.back();
  return last ? std::max(0.0, length - kBeforeTheEnd) : length;
}

bool DrivenFleet::putOnLane(const std::string& id, const LanePlace& place) {
  const std::string& lane_id = graph_.network().lane(place.lane).id;
  const double position = place.arc_length * sumoScale(place.lane);
  return link_.attempt([&] { calls_.moveTo(id, lane_id, position); });
}

bool DrivenFleet::moveAlongLane(const std::string& id, Moved& moved, const FrontPlace& place) {
  const bool known =
      moved.place.lane != map::kNoLane && graph_.onRoute(moved.place.lane, moved.given);
  const LanePlace from = known ? moved.place : LanePlace{};
  std::optional<LaneTarget> target =
      laneTarget(graph_, place, moved.state.heading, moved.given, from);
  if (!target) return false;
  const double excess = target->place.arc_length - usableLength(target->place.lane, moved);
  if (excess > 0.0) {
    target->place.arc_length -= excess;
    if (target->ahead) *target->ahead -= excess;
  }
  if (!target->ahead || std::abs(*target->ahead) > kFarOff) {
    LanePlace before = target->place;
    before.arc_length = std::max(0.0, before.arc_length - moved.state.speed * step_);
    if (!mayJump(moved) || !putOnLane(id, before)) return false;
    target->ahead = target->place.arc_length - before.arc_length;
  }
  double speed = commandedSpeed(moved.state.speed, *target->ahead, step_);
  if (excess > 0.0) speed = std::clamp(*target->ahead / step_, 0.0, speed);
  if (speed != moved.speed) calls_.setSpeed(id, speed);
  moved.speed = speed;
  moved.along_lane = true;
  moved.placed = false;
  return true;
}

bool DrivenFleet::mayJump(const Moved& moved) const {
  constexpr double kClear = 0.1;  // [m]
  if (moved.changing > 0.0) return false;
  const double needed = moved.route.dimensions().length + kClear;
  return moved.place.lane == map::kNoLane || moved.place.arc_length > needed;
}

bool DrivenFleet::mayLeaveRoad(const Moved& moved, const FrontPlace& place) const {
  return !moved.placed || !place.lanes.empty() || moved.place.lane == map::kNoLane;
}

void DrivenFleet::keepToLane(const std::string& id, Moved& moved, const FrontPlace& place) {
  const geometry::Polyline& line = graph_.network().lane(moved.place.lane).centerline;
  const double ahead = line.project(place.position).arc_length - moved.place.arc_length;
  moved.speed = commandedSpeed(moved.state.speed, ahead, step_);
  moved.placed = false;
  calls_.setSpeed(id, moved.speed);
}

bool DrivenFleet::onAnotherLane(const FrontPlace& place, map::LaneIndex lane) const {
  constexpr double kInside = 0.1;  // [m]
  if (place.lanes.empty() || place.lanes.front().lane == lane) return false;
  const map::LaneMatch& nearest = place.lanes.front();
  const double half_width = 0.5 * graph_.network().lane(nearest.lane).width;
  return nearest.projection.distance < half_width - kInside;
}

bool DrivenFleet::stayOnLane(const std::string& id, Moved& moved, const FrontPlace& place) {
  constexpr double kReachMargin = 0.3;  // [m] beyond which SUMO surely has it on no lane
  if (moved.place.lane == map::kNoLane) return false;
  const map::Lane& lane = graph_.network().lane(moved.place.lane);
  const geometry::Projection here = lane.centerline.project(place.position);
  const double reach = 0.5 * (lane.width + moved.route.dimensions().width) + kReachMargin;
  if (here.distance > reach || onAnotherLane(place, moved.place.lane)) return false;
  if (!putOnLane(id, {moved.place.lane, here.arc_length})) return false;
  if (moved.speed != 0.0) calls_.setSpeed(id, 0.0);
  moved.speed = 0.0;
  moved.along_lane = false;
  moved.placed = true;
  return true;
}

void DrivenFleet::moveFreely(const std::string& id, Moved& moved, const FrontPlace& place) {
  // A named lane is taken for what it is; without one SUMO takes the nearest in the plane, be it
  // that of a bridge.
  std::string edge;
  int index = 0;
  if (!place.lanes.empty()) {
    const map::Lane& lane = graph_.network().lane(place.lanes.front().lane);
    edge = lane.edge_id;
    index = lane.index;
  }
  const bool first = !moved.reported && moved.on_route;
  calls_.moveFreely(id, {edge, index, place.position, angleFromHeading(moved.state.heading),
                         first ? kKeepRouteExact : kAnywhere, match_threshold_});
  moved.along_lane = false;
}

void DrivenFleet::move(const DrivenVehicle& vehicle) {
  const auto found = vehicles_.find(vehicle.id);
  if (found == vehicles_.end()) {
    throw core::SimulatorError("vehicle '" + vehicle.id +
                               "' is moved but was neither added nor taken over");
  }
  Moved& moved = found->second;
  moved.state = vehicle.state;
  const FrontPlace place = moved.route.locate(vehicle.state);
  if (moved.route.follow(vehicle.route, place.position)) {
    moved.outdated = true;
    moved.refused_lane.clear();
  }
  moved.changing -= step_;
  updateRoute(vehicle.id, moved, place);
  if (moved.reported && moved.on_route && moveAlongLane(vehicle.id, moved, place)) return;
  if (moved.reported && !mayJump(moved)) {
    if (moved.place.lane != map::kNoLane) keepToLane(vehicle.id, moved, place);
    return;
  }
  if (moved.reported && stayOnLane(vehicle.id, moved, place)) return;
  if (moved.reported && !mayLeaveRoad(moved, place)) {
    keepToLane(vehicle.id, moved, place);
    return;
  }
  moved.placed = false;
  moveFreely(vehicle.id, moved, place);
}

void DrivenFleet::note(Moved& moved, const SimulatedVehicle& vehicle) const {
  moved.reported = true;
  moved.state = vehicle.state;
  moved.lane_id = vehicle.lane_id;
  moved.place = {};
  const map::LaneIndex lane = graph_.network().findLane(vehicle.lane_id);
  if (vehicle.lane_id.empty() || lane == map::kNoLane) return;
  const Eigen::Vector2d front = frontOf(vehicle.state.pose(), vehicle.dimensions.length);
  moved.place = {lane, graph_.network().lane(lane).centerline.project(front).arc_length};
}

namespace {

constexpr double kShortestReach = 3.0;     ///< along which the differences decay [m]
constexpr double kReachTime = 0.8;         ///< the same at speed [s]
constexpr double kLargestCurvature = 0.2;  ///< of the vehicle against its lane [1/m]
constexpr double kSettledOffset = 0.01;    ///< [m]
constexpr double kSettledHeading = 0.005;  ///< [rad]

constexpr double kReleasedRouteLength = 600.0;       ///< given at the release [m]
constexpr double kReleaseHeading = core::kPi / 6.0;  ///< between vehicle and lane [rad]
constexpr double kLaneChangePause = 3.0;             ///< without lane changes once settled [s]
constexpr double kLaneChangeTime = 3.5;              ///< SUMO's lane change, and a little [s]
constexpr int kLaneChangeModeDefault = 1621;

}  // namespace

void SettlingMotion::start(const traffic::VehicleState& sumo, double step) {
  // Straight on from the release at its speed; the differences to SUMO are what has to decay.
  const Eigen::Vector2d front = frontOf(state_.pose(), length_) + state_.velocity() * step;
  const geometry::Pose2d reference{frontOf(sumo.pose(), length_), sumo.heading};
  const Eigen::Vector2d difference = reference.toBody(front);
  along_ = difference.x();
  offset_ = difference.y();
  heading_error_ = core::angleDifference(state_.heading, sumo.heading);
  begun_ = true;
}

void SettlingMotion::decay(double driven, double speed) {
  const double reach = std::max(kShortestReach, kReachTime * speed);
  const double wanted = -offset_ / (reach * reach) - 2.0 * heading_error_ / reach;
  heading_error_ += driven * std::clamp(wanted, -kLargestCurvature, kLargestCurvature);
  offset_ += driven * std::sin(heading_error_);
  along_ -= along_ * std::min(1.0, driven / reach);
}

const traffic::VehicleState& SettlingMotion::advance(const traffic::VehicleState& sumo,
                                                     double step) {
  if (begun_) {
    decay(sumo.speed * step, sumo.speed);
  } else {
    start(sumo, step);
  }
  const geometry::Pose2d reference{frontOf(sumo.pose(), length_), sumo.heading};
  state_ = sumo;
  state_.heading = core::wrapAngle(sumo.heading + heading_error_);
  state_.position = centerBehind(reference.toMap({along_, offset_}), state_.heading, length_);
  return state_;
}

bool SettlingMotion::settled() const {
  return begun_ && std::abs(offset_) < kSettledOffset && std::abs(along_) < kSettledOffset &&
         std::abs(heading_error_) < kSettledHeading;
}

// DrivenFleet: vehicles that change hands, and what is reported of ours.

/// SUMO 1.15 ends itself when a vehicle is put on another lane while it changes lanes.
bool DrivenFleet::changesLane(const Moved& moved) const {
  constexpr double kBesideTheMiddle = 0.02;  // [m]
  if (moved.place.lane == map::kNoLane) return false;
  const geometry::Polyline& line = graph_.network().lane(moved.place.lane).centerline;
  const Eigen::Vector2d front = frontOf(moved.state.pose(), moved.route.dimensions().length);
  return line.project(front).distance > kBesideTheMiddle;
}

void DrivenFleet::takeOver(const SimulatedVehicle& vehicle) {
  Moved moved(DrivenRoute(graph_, vehicle.dimensions));
  moved.on_route = true;
  moved.outdated = true;
  for (const std::string& edge : calls_.routeOf(vehicle.id)) {
    moved.given.push_back(graph_.find(edge));
  }
  note(moved, vehicle);
  if (changesLane(moved)) moved.changing = kLaneChangeTime;
  setModes(vehicle.id, kSpeedModeOff);
  forget(vehicle.id);
  vehicles_.emplace(vehicle.id, std::move(moved));
}

bool DrivenFleet::release(const DrivenVehicle& vehicle) {
  Moved& moved = vehicles_.at(vehicle.id);
  const FrontPlace place = moved.route.locate(vehicle.state);
  moved.route.follow(vehicle.route, place.position);
  const int current = edgeOf(moved.lane_id);
  if (current == kNoEdge) return false;
  const bool given =
      setRoute(vehicle.id, moved, moved.route.edgesFrom(current, kReleasedRouteLength));
  if (!given && !moved.on_route) return false;
  const std::optional<LaneTarget> target =
      laneTarget(graph_, place, vehicle.state.heading, moved.given, moved.place);
  if (!target) return false;
  const double length = moved.route.dimensions().length;
  const geometry::Polyline& line = graph_.network().lane(target->place.lane).centerline;
  const double turned =
      core::angleDifference(vehicle.state.heading, line.headingAt(target->place.arc_length));
  if (std::abs(turned) > kReleaseHeading) return false;
  if (mayJump(moved) && !putOnLane(vehicle.id, target->place)) return false;
  setModes(vehicle.id, kSpeedModeDefault);
  calls_.setPreviousSpeed(vehicle.id, vehicle.state.speed);
  calls_.setSpeed(vehicle.id, -1.0);
  const Released released{SettlingMotion(vehicle.state, length), false, kLaneChangePause};
  forget(vehicle.id);
  released_.emplace(vehicle.id, released);
  return true;
}

bool DrivenFleet::settle(SimulatedVehicle& vehicle, Released& released) {
  if (!released.settled) {
    vehicle.state = released.motion.advance(vehicle.state, step_);
    released.settled = released.motion.settled();
    return true;
  }
  released.left -= step_;
  if (released.left > 0.0) return true;
  link_.attempt([&] { calls_.setLaneChangeMode(vehicle.id, kLaneChangeModeDefault); });
  return false;
}

void DrivenFleet::report(std::vector<SimulatedVehicle>& vehicles) {
  for (auto& [id, moved] : vehicles_) moved.reported = false;
  std::map<std::string, Released> still_released;
  for (SimulatedVehicle& vehicle : vehicles) {
    const auto moved = vehicles_.find(vehicle.id);
    if (moved != vehicles_.end()) {
      const traffic::VehicleState state = moved->second.state;
      note(moved->second, vehicle);
      moved->second.along_lane = moved->second.along_lane && !vehicle.lane_id.empty();
      vehicle.state = state;
    }
    const auto released = released_.find(vehicle.id);
    if (released != released_.end() && settle(vehicle, released->second)) {
      still_released.insert(*released);
    }
  }
  released_ = std::move(still_released);
}

}  // namespace cdiff::simulation
