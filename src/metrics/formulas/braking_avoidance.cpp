// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/braking_avoidance.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "metrics/formulas/free_road.h"

namespace cdiff::metrics {
namespace {

using geometry::OrientedBox;
using traffic::Vehicle;

constexpr double kReaction = 0.5;      // [s]
constexpr double kDeceleration = 6.0;  // [m/s^2]
constexpr double kOffRoute = 2.0;      // [m] farther off, the route is not the ego's path
constexpr double kSameInstant = 1e-6;  // [s]

bool hasFinitePose(const Vehicle& vehicle) {
  return vehicle.state.position.allFinite() && std::isfinite(vehicle.state.heading) &&
         std::isfinite(vehicle.state.speed);
}

OrientedBox straightAhead(const Vehicle& ego, double length) {
  return {ego.state.position + 0.5 * length * geometry::direction(ego.state.heading),
          ego.state.heading, length, ego.dimensions.width};
}

}  // namespace

void BrakingAvoidance::observe(const traffic::TrafficSnapshot& snapshot, double ego_arc_length) {
  const Vehicle* ego = snapshot.ego();
  if (ego == nullptr || !hasFinitePose(*ego)) {
    intruders_.clear();
    places_.clear();
    return;
  }
  follow(snapshot, *ego, sweptPath(*ego, ego_arc_length));
}

std::vector<OrientedBox> BrakingAvoidance::sweptPath(const Vehicle& ego,
                                                     double ego_arc_length) const {
  const double speed = ego.state.speed;
  const double ahead = 0.5 * ego.dimensions.length + speed * (kReaction + speed / kDeceleration);
  std::vector<OrientedBox> swept;
  if (!route_.empty()) {
    const auto near =
        route_.path().projectNear(ego.state.position, ego_arc_length, map::kRouteWindow);
    if (near.distance <= kOffRoute) {
      swept =
          stripAlong(route_.path(), near.arc_length, near.arc_length + ahead, ego.dimensions.width);
    }
  }
  if (swept.empty()) swept.push_back(straightAhead(ego, ahead));
  swept.push_back(ego.box());
  return swept;
}

/// Intruders that have left the path are forgotten, and the ego's places with the last of them.
void BrakingAvoidance::follow(const traffic::TrafficSnapshot& snapshot, const Vehicle& ego,
                              const std::vector<OrientedBox>& swept) {
  std::map<std::string, Intruder> intruders;
  std::vector<const Vehicle*> entering;
  for (const Vehicle& other : snapshot.vehicles) {
    if (&other == &ego || !hasFinitePose(other) || traffic::onDifferentLevels(ego, other)) continue;
    if (!overlapsStrip(other.box(), swept)) continue;
    const auto known = intruders_.find(other.id);
    if (known == intruders_.end()) {
      entering.push_back(&other);
      continue;
    }
    Intruder& intruder = intruders[other.id] = std::move(known->second);
    intruder.boxes.push_back(other.box());
    intruder.velocity = other.state.velocity();
  }
  if (intruders.empty()) places_.clear();
  for (const Vehicle* other : entering)
    intruders[other->id] = {places_.size(), {other->box()}, other->state.velocity()};
  intruders_.swap(intruders);
  if (!intruders_.empty()) place(snapshot.time, ego);
}

void BrakingAvoidance::place(double time, const Vehicle& ego) {
  double distance = 0.0;
  if (!places_.empty()) {
    distance = places_.back().distance + (ego.state.position - places_.back().box.center).norm();
  }
  places_.push_back({time, ego.box(), ego.state.speed, distance});
}

std::size_t BrakingAvoidance::brakingPlace(const Intruder& intruder) const {
  const double begin = places_[intruder.entered].time + kReaction - kSameInstant;
  const auto found = std::find_if(places_.begin(), places_.end(),
                                  [&](const EgoPlace& place) { return place.time >= begin; });
  return static_cast<std::size_t>(found - places_.begin());
}

OrientedBox BrakingAvoidance::boxAt(double distance) const {
  const auto after =
      std::upper_bound(places_.begin(), places_.end(), distance,
                       [](double value, const EgoPlace& place) { return value < place.distance; });
  if (after == places_.begin()) return places_.front().box;
  const EgoPlace& from = *(after - 1);
  OrientedBox box = from.box;
  if (after == places_.end()) {
    box.center += (distance - from.distance) * geometry::direction(box.heading);
    return box;
  }
  const double share = (distance - from.distance) / (after->distance - from.distance);
  box.center += share * (after->box.center - box.center);
  box.heading += share * core::angleDifference(after->box.heading, box.heading);
  return box;
}

double BrakingAvoidance::brakedDistance(std::size_t braking, double time) const {
  const EgoPlace& begin = places_[braking];
  const double since = std::min(time - begin.time, begin.speed / kDeceleration);
  return begin.distance + begin.speed * since - 0.5 * kDeceleration * since * since;
}

bool BrakingAvoidance::meetsUntilContact(const Intruder& intruder, std::size_t braking) const {
  for (std::size_t i = braking; i < places_.size(); ++i) {
    const double distance = std::min(places_[i].distance, brakedDistance(braking, places_[i].time));
    if (overlap(boxAt(distance), intruder.boxes[i - intruder.entered])) return true;
  }
  return false;
}

bool BrakingAvoidance::meetsAfterContact(const Intruder& intruder, std::size_t braking) const {
  const double contact = places_.back().time;
  const double step = contact - places_[places_.size() - 2].time;
  const double stop = places_[braking].time + places_[braking].speed / kDeceleration;
  OrientedBox other = intruder.boxes.back();
  for (int i = 1; contact + (i - 1) * step < stop; ++i) {
    other.center = intruder.boxes.back().center + i * step * intruder.velocity;
    if (overlap(boxAt(brakedDistance(braking, contact + i * step)), other)) return true;
  }
  return false;
}

bool BrakingAvoidance::avoids(const std::string& partner) const {
  const auto found = intruders_.find(partner);
  if (found == intruders_.end()) return false;
  const Intruder& intruder = found->second;
  const std::size_t braking = brakingPlace(intruder);
  if (braking + 1 >= places_.size()) return false;
  return !meetsUntilContact(intruder, braking) && !meetsAfterContact(intruder, braking);
}

}  // namespace cdiff::metrics
