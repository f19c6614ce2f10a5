// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <libsumo/libtraci.h>

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "simulation/driven_fleet.h"
#include "simulation/sumo_link.h"

namespace cdiff::simulation {
namespace {

constexpr double kShortestReach = 3.0;     ///< along which the differences decay [m]
constexpr double kReachTime = 0.8;         ///< the same at speed [s]
constexpr double kLargestCurvature = 0.2;  ///< of the vehicle against its lane [1/m]
constexpr double kSettledOffset = 0.01;    ///< [m]
constexpr double kSettledHeading = 0.005;  ///< [rad]

using SumoVehicle = libtraci::Vehicle;

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
  for (const std::string& edge : SumoVehicle::getRoute(vehicle.id)) {
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
  SumoVehicle::setPreviousSpeed(vehicle.id, vehicle.state.speed, 0.0);
  SumoVehicle::setSpeed(vehicle.id, -1.0);
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
  link_.attempt([&] { SumoVehicle::setLaneChangeMode(vehicle.id, kLaneChangeModeDefault); });
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
