// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/simulation/driven_fleet.h"

#include <libsumo/libtraci.h>

#include <algorithm>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/simulation/sumo_conversion.h"

namespace cdiff::simulation {

namespace {

using SumoVehicle = libtraci::Vehicle;

constexpr double kWayLength = 250.0;          ///< given ahead of the present edge [m]
constexpr double kWayRefresh = 100.0;         ///< a new way is given when less is left [m]
constexpr double kReleasedWayLength = 600.0;  ///< given at the release [m]
constexpr double kReleaseHeading =
    core::kPi / 6.0;                      ///< between vehicle and lane at a release [rad]
constexpr double kLaneChangePause = 3.0;  ///< without lane changes once settled [s]
constexpr double kHardBraking = 9.0;      ///< SUMO's emergency braking [m/s^2]
constexpr double kAcceleration = 2.6;     ///< SUMO's passenger car [m/s^2]
constexpr int kSpeedModeOff = 32;         ///< none of SUMO's checks
constexpr int kSpeedModeDefault = 31;
constexpr int kLaneChangeModeOff = 512;  ///< no lane change of its own
constexpr int kLaneChangeModeDefault = 1621;
constexpr int kKeepRouteExact = 3;  ///< keep the route, at the exact place
constexpr int kAnywhere = 2;        ///< at the exact place, whatever lane is there

void setModes(const std::string& id, int speed_mode) {
  SumoVehicle::setSpeedMode(id, speed_mode);
  SumoVehicle::setLaneChangeMode(id, kLaneChangeModeOff);
}

/// Whether one way is the beginning of the other.
bool agree(const std::vector<int>& first, const std::vector<int>& second) {
  const auto common = static_cast<std::ptrdiff_t>(std::min(first.size(), second.size()));
  return std::equal(first.begin(), first.begin() + common, second.begin());
}

/// Edges of a way from the first `current` on; empty when it is not on it.
std::vector<int> restOf(const std::vector<int>& way, int current) {
  return {std::find(way.begin(), way.end(), current), way.end()};
}

}  // namespace

int DrivenFleet::edgeOf(const std::string& lane_id) const {
  if (lane_id.empty()) return kNoEdge;
  const map::LaneIndex lane = graph_.network().findLane(lane_id);
  return lane == map::kNoLane ? kNoEdge : graph_.edgeOf(lane);
}

void DrivenFleet::add(const DrivenVehicle& start, const traffic::VehicleDimensions& dimensions,
                      const std::string& type_id) {
  Moved moved{DrivenWay(graph_, dimensions), {}, false, false, "", kNoEdge, false, map::kNoLane};
  const FrontPlace place = moved.way.locate(start.state);
  moved.way.follow(start.route, place.position);
  int edge = moved.way.startEdge(place);
  moved.on_way = edge != kNoEdge;
  for (const map::LaneMatch& match : graph_.network().lanesNear(place.position, 200.0)) {
    if (edge == kNoEdge) edge = graph_.edgeOf(match.lane);
  }
  if (edge == kNoEdge) {
    throw core::InputError(
        "vehicle '" + start.id + "' starts at (" + core::formatNumber(start.state.position.x()) +
        ", " + core::formatNumber(start.state.position.y()) + "), 200 m from every road");
  }
  moved.given = moved.way.edgesFrom(edge, kWayLength);
  const std::string route_id = "driven_" + std::to_string(added_++) + "_" + start.id;
  libtraci::Route::add(route_id, graph_.ids(moved.given));
  SumoVehicle::add(start.id, route_id, type_id, "now", "first", "0", "0");
  setModes(start.id, kSpeedModeOff);
  forget(start.id);
  vehicles_.emplace(start.id, std::move(moved));
}

void DrivenFleet::takeOver(const std::string& id, const traffic::VehicleDimensions& dimensions) {
  Moved moved{DrivenWay(graph_, dimensions), {}, true, true, "", kNoEdge, false, map::kNoLane};
  for (const std::string& edge : SumoVehicle::getRoute(id))
    moved.given.push_back(graph_.find(edge));
  setModes(id, kSpeedModeOff);
  forget(id);
  vehicles_.emplace(id, std::move(moved));
}

void DrivenFleet::forget(const std::string& id) {
  vehicles_.erase(id);
  released_.erase(id);
}

void DrivenFleet::moveFront(const std::string& id, const Eigen::Vector2d& front, double heading,
                            bool on_way) {
  SumoVehicle::moveToXY(id, "", 0, front.x(), front.y(), angleFromHeading(heading),
                        on_way ? kKeepRouteExact : kAnywhere, match_threshold_);
}

bool DrivenFleet::giveWay(const std::string& id, Moved& moved, const std::vector<int>& way) {
  if (!link_.attempt([&] { SumoVehicle::setRoute(id, graph_.ids(way)); })) return false;
  moved.given = way;
  return true;
}

void DrivenFleet::loseWay(Moved& moved) {
  moved.on_way = false;
  moved.refused_lane.clear();
}

void DrivenFleet::avoidBlindLane(Moved& moved, const FrontPlace& place,
                                 const std::string& reported_lane) {
  const auto blind = [&moved](const map::LaneMatch& match) {
    return match.lane == moved.blind_lane;
  };
  if (std::none_of(place.lanes.begin(), place.lanes.end(), blind)) moved.blind_lane = map::kNoLane;
  if (!moved.moved_on_way || !moved.on_way || !reported_lane.empty()) return;
  loseWay(moved);
  moved.blind_lane = place.lanes.front().lane;
}

void DrivenFleet::updateWay(const std::string& id, Moved& moved, const FrontPlace& place,
                            const std::string& reported_lane) {
  if (moved.on_way && !moved.way.onWay(place, moved.given, core::kPi)) loseWay(moved);
  avoidBlindLane(moved, place, reported_lane);
  const int current = edgeOf(reported_lane);
  if (current == kNoEdge || moved.blind_lane != map::kNoLane) return;
  const std::vector<int> rest = restOf(moved.given, current);
  if (moved.on_way && rest.empty()) loseWay(moved);  // SUMO placed it on another road
  double left = 0.0;
  for (std::size_t i = 1; i < rest.size(); ++i) left += graph_.length(rest[i]);
  const bool enough = left >= kWayRefresh && rest.size() >= 3;
  if (current != moved.last_edge) moved.outdated = true;
  moved.last_edge = current;
  if (moved.on_way && enough && !moved.outdated) return;
  if (moved.refused_lane == reported_lane) return;
  const std::vector<int> way = moved.way.edgesFrom(current, kWayLength);
  const bool same = moved.on_way && (way == rest || (enough && agree(way, rest)));
  if (!same) {
    if (!moved.way.onWay(place, way, 0.5 * core::kPi)) return;
    if (!giveWay(id, moved, way)) {
      moved.refused_lane = reported_lane;
      return;
    }
    moved.on_way = true;
  }
  moved.outdated = false;
  moved.refused_lane = same ? reported_lane : "";
}

void DrivenFleet::move(const DrivenVehicle& vehicle, const std::string& reported_lane) {
  const auto found = vehicles_.find(vehicle.id);
  if (found == vehicles_.end()) {
    throw core::SimulatorError("vehicle '" + vehicle.id +
                               "' is moved but was neither added nor taken over");
  }
  Moved& moved = found->second;
  const FrontPlace place = moved.way.locate(vehicle.state);
  if (moved.way.follow(vehicle.route, place.position)) {
    moved.outdated = true;
    moved.refused_lane.clear();
  }
  updateWay(vehicle.id, moved, place, reported_lane);
  moveFront(vehicle.id, place.position, vehicle.state.heading, moved.on_way);
  moved.moved_on_way = moved.on_way;
}

bool DrivenFleet::release(const DrivenVehicle& vehicle, const std::string& reported_lane) {
  Moved& moved = vehicles_.at(vehicle.id);
  const FrontPlace place = moved.way.locate(vehicle.state);
  moved.way.follow(vehicle.route, place.position);
  const int current = edgeOf(reported_lane);
  if (current == kNoEdge) return false;
  const auto reported =
      std::find_if(place.lanes.begin(), place.lanes.end(), [&](const map::LaneMatch& match) {
        return graph_.network().lane(match.lane).id == reported_lane;
      });
  if (reported == place.lanes.end() || std::abs(reported->heading_difference) > kReleaseHeading)
    return false;
  const bool given = giveWay(vehicle.id, moved, moved.way.edgesFrom(current, kReleasedWayLength));
  if (!given && !moved.on_way) return false;
  setModes(vehicle.id, kSpeedModeDefault);
  SumoVehicle::setPreviousSpeed(vehicle.id, vehicle.state.speed, 0.0);
  SumoVehicle::setSpeed(vehicle.id, -1.0);
  Released released{SettlingMotion(graph_, reported->lane, moved.given, vehicle.state,
                                   moved.way.dimensions().length),
                    true, true, vehicle.state.speed, kLaneChangePause};
  forget(vehicle.id);
  released_.emplace(vehicle.id, std::move(released));
  return true;
}

void DrivenFleet::settle(const std::string& id, Released& released, double step) {
  if (released.motion.settled()) {
    released.settling = false;
    SumoVehicle::setPreviousSpeed(id, released.motion.state().speed, 0.0);
    return;
  }
  // SUMO's wish answers the step before the last: its change of speed counts, not the speed.
  const double last = released.motion.state().speed;
  double speed = last;
  if (!released.first) {
    const double wish = SumoVehicle::getSpeedWithoutTraCI(id) - released.speed_before;
    speed = std::max(0.0, last + std::clamp(wish, -kHardBraking * step, kAcceleration * step));
  }
  released.first = false;
  released.speed_before = last;
  const traffic::VehicleState& state = released.motion.advance(speed, step);
  moveFront(id, frontOf(state.pose(), released.motion.length()), state.heading, true);
}

std::map<std::string, double> DrivenFleet::settlingSpeeds() const {
  std::map<std::string, double> speeds;
  for (const auto& [id, released] : released_) {
    if (released.settling) speeds.emplace(id, released.motion.state().speed);
  }
  return speeds;
}

void DrivenFleet::advance(double step) {
  for (auto entry = released_.begin(); entry != released_.end();) {
    const std::string& id = entry->first;
    Released& released = entry->second;
    bool present = true;
    if (released.settling) present = link_.attempt([&] { settle(id, released, step); });
    if (!released.settling) released.left -= step;
    if (released.left <= 0.0) {
      link_.attempt([&] { SumoVehicle::setLaneChangeMode(id, kLaneChangeModeDefault); });
      present = false;
    }
    entry = present ? std::next(entry) : released_.erase(entry);
  }
}

}  // namespace cdiff::simulation
