// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/traffic_driver.h"

#include <algorithm>
#include <limits>

#include "cbv/candidate_gates.h"
#include "cbv/cbv_options.h"
#include "cbv/cbv_selector.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::collection {
namespace {

using map::LaneIndex;

constexpr std::uint32_t kFirstElement = 64;
constexpr double kLaneChangeRoom = 60.0;  // [m]

/// Draws lane after lane.
class RandomWalk {
 public:
  RandomWalk(const map::RoadNetwork& network, const core::RandomStream& random,
             const core::RandomKey& key)
      : network_(network), random_(random), key_(key) {}

  /// Lanes from `start` on, at least `length` beyond `begin` of it where the network allows; the
  /// length in `length` afterward.
  map::LanePath walk(LaneIndex start, double begin, double& length, double lane_change_share) {
    map::LanePath path;
    path.lanes.push_back(start);
    double end = lengthOf(start) - begin;
    while (end < length || network_.lane(path.lanes.back()).internal) {
      changeLane(path, lane_change_share);
      const LaneIndex next = follower(path.lanes.back());
      if (next == map::kNoLane) break;
      path.lanes.push_back(next);
      end += lengthOf(next);
    }
    length = end;
    path.length = end;
    return path;
  }

 private:
  double lengthOf(LaneIndex lane) const { return network_.lane(lane).centerline.length(); }

  std::vector<LaneIndex> followers(LaneIndex lane) const {
    std::vector<LaneIndex> lanes;
    for (const map::LaneLink& link : network_.lane(lane).next) {
      const bool back = link.direction == 't';
      if (!back && network_.lane(link.to).routable) lanes.push_back(link.to);
    }
    return lanes;
  }

  LaneIndex follower(LaneIndex lane) {
    const std::vector<LaneIndex> lanes = followers(lane);
    if (lanes.empty()) return map::kNoLane;
    return lanes[random_.index(key_, element_++, lanes.size())];
  }

  /// To a neighbor where the lane ends, or now and then on a long one.
  void changeLane(map::LanePath& path, double share) {
    const map::Lane& lane = network_.lane(path.lanes.back());
    const bool first = path.lanes.size() == 1;
    const bool long_enough = !lane.internal && !first && lane.centerline.length() > kLaneChangeRoom;
    const bool wished = long_enough && random_.uniform(key_, element_++) < share;
    const bool ends = followers(path.lanes.back()).empty();
    if (!wished && !ends) return;
    std::vector<LaneIndex> beside;
    for (const LaneIndex neighbor : {lane.right, lane.left}) {
      if (neighbor == map::kNoLane || !network_.lane(neighbor).routable) continue;
      if (!followers(neighbor).empty()) beside.push_back(neighbor);
    }
    if (beside.empty()) return;
    path.lanes.push_back(beside[random_.index(key_, element_++, beside.size())]);
  }

  const map::RoadNetwork& network_;
  const core::RandomStream& random_;
  core::RandomKey key_;
  std::uint32_t element_ = kFirstElement;
};

constexpr double kStandingSpeed = 0.1;  // [m/s]
constexpr int kTakenAtOnce = 2;         // vehicles a decision
constexpr double kNotAgain = 1.0;       // [s] after a failed try

}  // namespace

std::optional<map::Route> randomRoute(const map::LaneGraph& graph, const map::LanePosition& start,
                                      const RandomRouteOptions& options,
                                      const core::RandomStream& random,
                                      const core::RandomKey& key) {
  constexpr double kLeastLastLane = 2.0;  // [m]
  double length = options.length;
  const map::LanePath path =
      RandomWalk(graph.network(), random, key)
          .walk(start.lane, start.arc_length, length, options.lane_change_share);
  if (length < options.minimum_length) return std::nullopt;
  const map::Lane& last = graph.network().lane(path.lanes.back());
  if (last.internal) return std::nullopt;
  const double surplus = std::max(0.0, length - options.length);
  const double last_length = last.centerline.length();
  const double begin = path.lanes.size() == 1 ? start.arc_length : 0.0;
  const double goal =
      std::max(std::min(begin + kLeastLastLane, last_length), last_length - surplus);
  const map::Route route = graph.toRoute(path, start.arc_length, goal);
  if (route.length() < options.minimum_length) return std::nullopt;
  return route;
}

map::Route extendedAtRandom(const map::LaneGraph& graph, const map::Route& route, double length,
                            const core::RandomStream& random) {
  constexpr double kWorthIt = 20.0;  // [m]
  const double missing = length - route.length();
  if (missing < kWorthIt) return route;
  const Eigen::Vector3d end = route.path().points().back();
  const LaneIndex lane = route.lanes().back();
  const double begin = graph.network().lane(lane).centerline.project(end.head<2>()).arc_length;
  const RandomRouteOptions options{kWorthIt, missing, 0.0};
  const auto rest = randomRoute(graph, {lane, begin}, options, random, {});
  if (!rest) return route;
  std::vector<Eigen::Vector3d> points = route.path().points();
  std::vector<LaneIndex> lanes = route.lanes();
  for (std::size_t i = 1; i < rest->lanes().size(); ++i) {
    points.push_back(rest->path().points()[i]);
    lanes.push_back(rest->lanes()[i]);
  }
  return map::Route(graph.network(), points, lanes);
}

TrafficDriver::TrafficDriver(const CollectionOptions& options, const map::LaneGraph& graph,
                             const map::DrivableArea& area, std::uint64_t seed)
    : options_(options), graph_(graph), area_(area), random_(seed, "collection_routes") {
  options_.validate();
}

void TrafficDriver::observe(const traffic::TrafficSnapshot& snapshot) {
  for (const traffic::Contact& contact : snapshot.contacts) {
    contacted_.insert(contact.first);
    contacted_.insert(contact.second);
  }
}

cbv::CbvSelection TrafficDriver::update(const traffic::TrafficSnapshot& snapshot) {
  cbv::CbvSelection selection;
  selection.tick = snapshot.tick;
  observe(snapshot);
  updateHeld(snapshot, selection);
  fill(snapshot);
  contacted_.clear();
  for (const auto& [slot, held] : slots_) selection.assignments.push_back(held.assignment);
  return selection;
}

void TrafficDriver::updateHeld(const traffic::TrafficSnapshot& snapshot,
                               cbv::CbvSelection& selection) {
  for (auto entry = slots_.begin(); entry != slots_.end();) {
    const std::string id = entry->second.assignment.vehicle_id;
    const char* reason = releaseReason(snapshot, entry->second);
    if (reason == nullptr) {
      ++entry;
      continue;
    }
    selection.released.push_back({entry->first, id, reason});
    not_before_[id] = snapshot.time + options_.pause;
    entry = slots_.erase(entry);
  }
}

const char* TrafficDriver::releaseReason(const traffic::TrafficSnapshot& snapshot,
                                         Held& held) const {
  const std::string& id = held.assignment.vehicle_id;
  if (contacted_.count(id) != 0) return cbv::kContact;
  const traffic::Vehicle* vehicle = snapshot.find(id);
  if (vehicle == nullptr) return cbv::kGone;
  const map::Route& route = held.assignment.conflict_aware_route;
  const traffic::VehicleState& state = vehicle->state;
  held.follower.update(route, state.position);
  held.assignment.conflict_point.cbv_distance =
      std::max(0.0, route.length() - held.follower.arcLength());
  if (held.assignment.conflict_point.cbv_distance < options_.route_end) return cbv::kRouteEnd;
  const double inside = area_.signedDistance(state.position, state.elevation);
  if (inside < -options_.off_road_distance) return kLeftRoad;
  if (state.speed > kStandingSpeed)
    held.standing_since = -1.0;
  else if (held.standing_since < 0.0)
    held.standing_since = snapshot.time;
  const bool stood =
      held.standing_since >= 0.0 && snapshot.time - held.standing_since >= options_.standing_time;
  return stood ? kStoodTooLong : nullptr;
}

/// Distance to the nearest driven vehicle.
double TrafficDriver::spaceAround(const traffic::TrafficSnapshot& snapshot,
                                  const traffic::Vehicle& vehicle) const {
  double space = std::numeric_limits<double>::infinity();
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    const bool driven = other.role == traffic::VehicleRole::kEgo ||
                        std::any_of(slots_.begin(), slots_.end(), [&](const auto& slot) {
                          return slot.second.assignment.vehicle_id == other.id;
                        });
    if (!driven) continue;
    space = std::min(space, (other.state.position - vehicle.state.position).norm());
  }
  return space;
}

/// Those that may be driven, nearest to the ego first; crowded ones last.
std::vector<const traffic::Vehicle*> TrafficDriver::candidates(
    const traffic::TrafficSnapshot& snapshot) const {
  struct Ranked {
    bool crowded;
    double distance;
    const traffic::Vehicle* vehicle;
  };
  std::vector<Ranked> ranked;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role != traffic::VehicleRole::kBackground) continue;
    const auto pause = not_before_.find(vehicle.id);
    if (pause != not_before_.end() && snapshot.time < pause->second) continue;
    if (contacted_.count(vehicle.id) != 0) continue;
    const double distance = (vehicle.state.position - snapshot.ego()->state.position).norm();
    if (distance > options_.radius) continue;
    ranked.push_back({spaceAround(snapshot, vehicle) < options_.spacing, distance, &vehicle});
  }
  std::sort(ranked.begin(), ranked.end(), [](const Ranked& left, const Ranked& right) {
    if (left.crowded != right.crowded) return right.crowded;
    if (left.distance != right.distance) return left.distance < right.distance;
    return left.vehicle->id < right.vehicle->id;
  });
  std::vector<const traffic::Vehicle*> vehicles;
  for (const Ranked& one : ranked) vehicles.push_back(one.vehicle);
  return vehicles;
}

void TrafficDriver::fill(const traffic::TrafficSnapshot& snapshot) {
  if (snapshot.ego() == nullptr) return;
  int taken = 0;
  for (int slot = 0; slot < options_.vehicles && taken < kTakenAtOnce; ++slot) {
    if (slots_.count(slot) != 0) continue;
    const std::vector<const traffic::Vehicle*> all = candidates(snapshot);
    const auto fits = [&](const traffic::Vehicle* vehicle) {
      const bool held = std::any_of(slots_.begin(), slots_.end(), [&](const auto& entry) {
        return entry.second.assignment.vehicle_id == vehicle->id;
      });
      return !held && take(snapshot, *vehicle, slot);
    };
    if (std::none_of(all.begin(), all.end(), fits)) return;
    ++taken;
  }
}

bool TrafficDriver::take(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& vehicle,
                         int slot) {
  const cbv::LanePlacement placement =
      cbv::placeOnLane(graph_.network(), vehicle, cbv::CbvOptions());
  const RandomRouteOptions wished{options_.minimum_route, options_.route_length,
                                  options_.lane_change_share};
  const core::RandomKey key{core::hashText(vehicle.id), static_cast<std::uint32_t>(snapshot.tick),
                            0};
  std::optional<map::Route> route;
  if (placement.reason == nullptr)
    route = randomRoute(graph_, placement.place, wished, random_, key);
  if (!route) {
    not_before_[vehicle.id] = snapshot.time + kNotAgain;
    return false;
  }
  Held held;
  held.follower.update(*route, vehicle.state.position);
  held.assignment.slot = slot;
  held.assignment.vehicle_id = vehicle.id;
  held.assignment.selected_tick = snapshot.tick;
  held.assignment.conflict_point.position = route->path().points().back();
  held.assignment.conflict_point.cbv_distance = route->length();
  held.assignment.conflict_aware_route = std::move(*route);
  slots_.emplace(slot, std::move(held));
  return true;
}

}  // namespace cdiff::collection
