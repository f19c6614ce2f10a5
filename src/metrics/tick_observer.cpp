// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/tick_observer.h"

#include <algorithm>
#include <cmath>

#include "metrics/formulas/ttc_2d.h"

namespace cdiff::metrics {
namespace {

using traffic::TrafficSnapshot;
using traffic::Vehicle;
using traffic::VehicleRole;

/// Limit of the lane that a vehicle is on; off the road, of the nearest one.
std::optional<double> speedLimit(const Vehicle& vehicle, const map::RoadNetwork& network) {
  constexpr double kRadius = 5.0;  // [m] from a lane's centerline
  map::LaneIndex lane = network.findLane(vehicle.lane_id);
  if (lane == map::kNoLane) {
    const auto near = network.lanesNear(vehicle.state.position, vehicle.state.elevation, kRadius);
    if (!near.empty()) lane = near.front().lane;
  }
  if (lane == map::kNoLane) return std::nullopt;
  return network.lane(lane).speed_limit;
}

/// Of the centers; absent without ego, and where one passes under the other.
std::optional<double> distanceToEgo(const Vehicle& vehicle, const Vehicle* ego) {
  if (ego == nullptr || traffic::onDifferentLevels(vehicle, *ego)) return std::nullopt;
  return (vehicle.state.position - ego->state.position).norm();
}

}  // namespace

TickObserver::TickObserver(const MetricContext& context)
    : options_(context.options),
      drivable_area_(context.drivable_area),
      ego_contacts_(options_.network, options_.infractions.collision_minimum_speed),
      avoidance_(context.ego_route) {
  if (context.ego_route.empty()) return;
  progress_.emplace(context.ego_route, options_.completion_percent, options_.completion_distance);
}

MetricTick TickObserver::observe(const TrafficSnapshot& snapshot,
                                 const cbv::CbvSelection* selection) {
  MetricTick tick{snapshot, selection, snapshot.ego()};
  if (tick.ego != nullptr) addEgo(*tick.ego, tick);
  if (progress_) {
    tick.ego_arc_length = progress_->arcLength();
    tick.route_completion_percent = progress_->percent();
  }
  addContacts(tick);
  addCbvs(tick);
  return tick;
}

bool TickObserver::offRoad(const Vehicle& vehicle) const {
  const auto& state = vehicle.state;
  if (!state.position.allFinite()) return false;
  return drivable_area_.signedDistance(state.position, state.elevation) < 0.0;
}

/// All corners are looked for on the level of the vehicle.
std::optional<double> TickObserver::edgeDistance(const Vehicle& vehicle) const {
  const auto& state = vehicle.state;
  if (!state.position.allFinite() || !std::isfinite(state.heading)) return std::nullopt;
  return drivable_area_.signedDistance(vehicle.box(), state.elevation);
}

double TickObserver::wantedSpeed(const Vehicle& vehicle) const {
  const double target =
      options_.cbv_target_speed ? options_.cbv_target_speed(vehicle.id) : options_.target_speed;
  if (options_.network == nullptr || !vehicle.state.position.allFinite()) return target;
  const std::optional<double> limit = speedLimit(vehicle, *options_.network);
  return std::min(target, limit.value_or(target));
}

/// By the role now, or at the last tick for a vehicle that this contact removed. Call before
/// addCbvs.
bool TickObserver::isCbv(const TrafficSnapshot& snapshot, const std::string& id) const {
  const Vehicle* vehicle = snapshot.find(id);
  return vehicle != nullptr ? vehicle->role == VehicleRole::kCbv : last_positions_.count(id) != 0;
}

void TickObserver::addEgo(const Vehicle& ego, MetricTick& tick) {
  ego_id_ = ego.id;
  tick.ego_off_road = offRoad(ego);
  if (progress_ && ego.state.position.allFinite()) progress_->update(ego.state.position);
  tick.interaction = interactionOf(
      ego, tick.snapshot, {options_.ttc_radius, options_.ttc_limit, tick.snapshot.decision_tick});
}

ContactSighting TickObserver::sightingOf(const traffic::Contact& contact,
                                         const MetricTick& tick) const {
  ContactSighting sighting;
  if (contact.first == ego_id_ || contact.second == ego_id_)
    sighting.ego_partner = contact.first == ego_id_ ? contact.second : contact.first;
  for (const std::string* id : {&contact.first, &contact.second}) {
    if (isCbv(tick.snapshot, *id)) sighting.cbvs.push_back(*id);
  }
  const bool ego = !sighting.ego_partner.empty();
  if (!ego && sighting.cbvs.empty()) return sighting;
  const std::string& judged = ego ? ego_id_ : sighting.cbvs.front();
  sighting.striker = ego_contacts_.strikerOf(
      tick.snapshot, judged, judged == contact.first ? contact.second : contact.first);
  return sighting;
}

void TickObserver::addContacts(MetricTick& tick) {
  for (const traffic::Contact& contact : tick.snapshot.contacts)
    tick.contacts.push_back(sightingOf(contact, tick));
  const auto known = static_cast<std::ptrdiff_t>(ego_contacts_.contacts().size());
  ego_contacts_.observe(tick.snapshot);
  tick.ego_contacts.assign(ego_contacts_.contacts().begin() + known,
                           ego_contacts_.contacts().end());
  avoidance_.observe(tick.snapshot, tick.ego_arc_length);
  for (EgoContact& contact : tick.ego_contacts) {
    contact.braking_avoids = avoidance_.avoids(contact.partner);
    contact.with_cbv = isCbv(tick.snapshot, contact.partner);
  }
}

void TickObserver::addCbvs(MetricTick& tick) {
  std::map<std::string, Eigen::Vector2d> positions;
  for (const Vehicle& vehicle : tick.snapshot.vehicles) {
    if (vehicle.role != VehicleRole::kCbv) continue;
    const std::optional<double> edge = edgeDistance(vehicle);
    tick.cbvs.push_back({&vehicle, offRoad(vehicle), wantedSpeed(vehicle),
                         distanceToEgo(vehicle, tick.ego), edge.value_or(0.0) < 0.0, 0.0, edge});
    if (!tick.cbvs.back().placed()) continue;
    const auto last = last_positions_.find(vehicle.id);
    if (last != last_positions_.end())
      tick.cbvs.back().chord = (vehicle.state.position - last->second).norm();
    positions[vehicle.id] = vehicle.state.position;
  }
  last_positions_.swap(positions);
}

}  // namespace cdiff::metrics
