// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/wait_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/text.h"

namespace cdiff::record {
namespace {

using traffic::Vehicle;

constexpr double kAhead = 20.0;        ///< from the front bumper to an obstacle [m]
constexpr double kToLine = 15.0;       ///< from the front bumper to the junction it waits at [m]
constexpr double kToEntry = 25.0;      ///< of another vehicle from the same junction [m]
constexpr double kSideRoom = 0.4;      ///< beside the ego's box that others must leave free [m]
constexpr double kWaitingSpeed = 0.5;  ///< slower is waiting [m/s]
constexpr double kGap = 3.0;        ///< SUMO's gap of 2.5 m, and what vehicles stop short of it [m]
constexpr double kStopSlack = 1.0;  ///< of the place where a vehicle stops [m]
constexpr std::size_t kLongestChain = 8;  ///< internal lanes in a row
constexpr double kMeeting = 2.0;          ///< nearer center lines of two ways meet [m]

/// Lanes in a junction, one after the other.
using Way = std::vector<map::LaneIndex>;

/// A vehicle and how far it is.
struct Nearest {
  const Vehicle* vehicle = nullptr;
  double distance = std::numeric_limits<double>::infinity();

  /// The first of equals stays.
  void take(const Vehicle& other, double other_distance) {
    const bool tie = vehicle != nullptr && other_distance == distance && other.id < vehicle->id;
    if (other_distance < distance || tie) *this = {&other, other_distance};
  }
};

Eigen::Vector2d frontOf(const Vehicle& vehicle) {
  return vehicle.state.position +
         0.5 * vehicle.dimensions.length * geometry::direction(vehicle.state.heading);
}

std::vector<Eigen::Vector2d> outlineOf(const Vehicle& vehicle) {
  const Eigen::Vector2d along = geometry::direction(vehicle.state.heading);
  const Eigen::Vector2d across(-along.y(), along.x());
  std::vector<Eigen::Vector2d> points;
  for (const double forward : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
    for (const double left : {-0.5, 0.5}) {
      points.push_back(vehicle.state.position + forward * vehicle.dimensions.length * along +
                       left * vehicle.dimensions.width * across);
    }
  }
  return points;
}

/// Whether a vehicle with its front there stands where it is ordered to.
bool isAt(const session::DemandStop& stop, double front, double lane_length) {
  const auto place = [&](double position) {
    return position < 0.0 ? position + lane_length : position;
  };
  const double end = place(stop.end.value_or(lane_length));
  const double begin = stop.begin ? place(*stop.begin) : end;
  return front > begin - kStopSlack && front < end + kStopSlack;
}

std::string untilText(const session::DemandStop& stop) {
  if (stop.until) return "until " + core::formatNumber(*stop.until) + " s of SUMO's clock";
  if (stop.duration) return "for " + core::formatNumber(*stop.duration) + " s";
  return "until something lets it go";
}

/// Finds what one vehicle after the other waits for in one snapshot.
class WaitSearch {
 public:
  WaitSearch(const traffic::TrafficSnapshot& snapshot, const map::RoadNetwork& network,
             const KnownDemand& demand)
      : snapshot_(snapshot), network_(network), demand_(demand) {}

  Wait ofEgo(const Vehicle& ego, const map::Route& route) const {
    const geometry::Polyline& path = route.path();
    const double front = path.project(frontOf(ego)).arc_length;
    if (const Vehicle* leader = onRoute(ego, route, front, kAhead).vehicle)
      return behind(ego, *leader, "");
    for (const map::Route::Signal& signal : route.signals()) {
      const double ahead = signal.arc_length - front;
      if (ahead < -1.0 || ahead > kToLine || isGreen(signal.id, signal.link)) continue;
      return {ego.id, Wait::For::kLight, signal.id, junctionAhead(route, signal.arc_length)};
    }
    const std::string junction = junctionAhead(route, front);
    if (const Vehicle* last = beyondJunction(ego, route, front))
      return behind(ego, *last, junction);
    if (const Vehicle* other = inJunction(ego, junction, {waysOfRoute(route, front)}))
      return lets(ego, *other, junction);
    for (const double line : route.stopSigns()) {
      if (line - front > -1.0 && line - front < kToLine)
        return {ego.id, Wait::For::kStopLine, "", junction};
    }
    return {ego.id, Wait::For::kNothing, "", junction};
  }

  Wait of(const Vehicle& vehicle) const {
    const map::LaneIndex index = laneOf(vehicle);
    if (index == map::kNoLane) return {vehicle.id, Wait::For::kNothing, "", ""};
    const map::Lane& lane = network_.lane(index);
    const double front = lane.centerline.project(frontOf(vehicle)).arc_length;
    const double to_line = lane.centerline.length() - front;
    if (const auto stop = stopOf(vehicle, lane, front)) return *stop;
    Nearest leader;
    followLanes(vehicle, index, -front, kAhead, leader);
    const bool near_end = !lane.internal && to_line < kToLine;
    const bool at_line = near_end && !lane.next.empty();
    const bool queue = leader.vehicle != nullptr &&
                       (lane.internal || !at_line || laneOf(*leader.vehicle) == index);
    if (queue) return behind(vehicle, *leader.vehicle, lane.internal ? lane.junction_id : "");
    if (near_end && !at_line) return {vehicle.id, Wait::For::kNoWay, lane.id, ""};
    if (!lane.internal && !at_line) return {vehicle.id, Wait::For::kNothing, "", ""};
    const std::string red = at_line ? redLight(vehicle, lane) : "";
    if (!red.empty()) return {vehicle.id, Wait::For::kLight, red, lane.junction_id};
    if (leader.vehicle != nullptr) return behind(vehicle, *leader.vehicle, lane.junction_id);
    return atJunction(vehicle, index, to_line);
  }

 private:
  static Wait behind(const Vehicle& vehicle, const Vehicle& obstacle, const std::string& junction) {
    return {vehicle.id, Wait::For::kVehicle, obstacle.id, junction};
  }

  /// Lets another pass the junction first, unless that one stands in it.
  Wait lets(const Vehicle& vehicle, const Vehicle& other, const std::string& junction) const {
    Wait wait = behind(vehicle, other, junction);
    const bool inside = network_.lane(laneOf(other)).internal;
    wait.yields = !inside || other.state.speed > kWaitingSpeed;
    return wait;
  }

  /// Where the demand orders the vehicle to stand, and until when.
  std::optional<Wait> stopOf(const Vehicle& vehicle, const map::Lane& lane, double front) const {
    if (demand_.file == nullptr || lane.internal) return std::nullopt;
    for (const session::DemandStop& stop : demand_.file->stopsOf(vehicle.id)) {
      const bool here = stop.lane.empty() ? stop.edge == lane.edge_id : stop.lane == lane.id;
      const bool over = stop.until && *stop.until < demand_.clock;
      if (!here || over || !isAt(stop, front, lane.centerline.length())) continue;
      return Wait{vehicle.id, Wait::For::kStop, lane.id, "", false, untilText(stop)};
    }
    return std::nullopt;
  }

  /// Of a vehicle at a junction or in it, without anything in its lane or a red light.
  Wait atJunction(const Vehicle& vehicle, map::LaneIndex index, double to_line) const {
    const std::string& junction = network_.lane(index).junction_id;
    const std::vector<Way> ways = waysFrom(vehicle, index);
    Nearest last;
    bool free = ways.empty();
    for (const Way& way : ways) {
      Nearest here;
      double begin = to_line;
      for (const map::LaneIndex inner : way)
        begin += inner == index ? 0.0 : network_.lane(inner).centerline.length();
      for (const map::LaneLink& link : network_.lane(way.back()).next)
        followLanes(vehicle, link.to, begin, begin + vehicle.dimensions.length + kGap, here);
      const bool full = here.vehicle != nullptr && here.vehicle->state.speed < kWaitingSpeed;
      if (full) last.take(*here.vehicle, here.distance);
      free = free || !full;
    }
    if (!free) return behind(vehicle, *last.vehicle, junction);
    if (const Vehicle* other = inJunction(vehicle, junction, ways))
      return lets(vehicle, *other, junction);
    if (last.vehicle != nullptr) return behind(vehicle, *last.vehicle, junction);
    return {vehicle.id, Wait::For::kNothing, "", junction};
  }

  /// Lanes in the junction that lead on from a lane before it, or on from one in it, which comes
  /// first.
  std::vector<Way> waysFrom(const Vehicle& vehicle, map::LaneIndex index) const {
    std::vector<Way> ways;
    if (network_.lane(index).internal) {
      ways.push_back({index});
    } else {
      for (const map::LaneLink& link : linksOf(vehicle, network_.lane(index))) {
        if (network_.lane(link.to).internal) ways.push_back({link.to});
      }
    }
    for (Way& way : ways) {
      while (way.size() < kLongestChain && !network_.lane(way.back()).next.empty()) {
        const map::LaneIndex next = network_.lane(way.back()).next.front().to;
        if (!network_.lane(next).internal) break;
        way.push_back(next);
      }
    }
    return ways;
  }

  /// Lanes of the ego's route in the junction that its front is in or before.
  Way waysOfRoute(const map::Route& route, double front) const {
    Way way;
    for (const auto& [begin, end] : route.junctionStretches()) {
      if (front >= end || begin - front >= kToLine) continue;
      for (double place = std::max(begin, front); place < end; place += 1.0) {
        const map::LaneIndex lane = route.laneAt(place);
        if (network_.lane(lane).internal && (way.empty() || way.back() != lane))
          way.push_back(lane);
      }
      break;
    }
    return way;
  }

  /// Links from a lane by which the vehicle can drive: those to its next edge where the demand says
  /// which that is, else all.
  std::vector<map::LaneLink> linksOf(const Vehicle& vehicle, const map::Lane& lane) const {
    if (demand_.file == nullptr || lane.internal) return lane.next;
    const std::vector<std::string> route = demand_.file->routeOf(vehicle.id);
    const auto now = std::find(route.begin(), route.end(), lane.edge_id);
    if (now == route.end() || std::next(now) == route.end()) return lane.next;
    std::vector<map::LaneLink> links;
    for (const map::LaneLink& link : lane.next) {
      map::LaneIndex exit = link.to;
      for (std::size_t i = 0;
           i < kLongestChain && network_.lane(exit).internal && !network_.lane(exit).next.empty();
           ++i)
        exit = network_.lane(exit).next.front().to;
      if (network_.lane(exit).edge_id == *std::next(now)) links.push_back(link);
    }
    return links.empty() ? lane.next : links;
  }

  /// Whether a way meets one of others; so they do where nothing is known of one.
  bool meet(const std::vector<Way>& ways, const std::vector<Way>& others) const {
    if (ways.empty() || others.empty()) return true;
    for (const Way& way : ways) {
      for (const Way& other : others) {
        if (way.empty() || other.empty() || meet(way, other)) return true;
      }
    }
    return false;
  }
  bool meet(const Way& way, const Way& other) const {
    for (const map::LaneIndex one : way) {
      const geometry::Polyline& line = network_.lane(one).centerline;
      for (const map::LaneIndex two : other) {
        for (double place = 0.0; place <= line.length(); place += 1.0) {
          const auto near = network_.lane(two).centerline.project(line.positionAt(place));
          if (near.distance < kMeeting) return true;
        }
      }
    }
    return false;
  }

  /// One that stands behind the junction, in or before which the ego is, and leaves no room for it.
  const Vehicle* beyondJunction(const Vehicle& ego, const map::Route& route, double front) const {
    for (const auto& [begin, end] : route.junctionStretches()) {
      if (front >= end || begin - front >= kToLine) continue;
      const double reach = end - front + ego.dimensions.length + kGap;
      const Vehicle* last = onRoute(ego, route, front, reach).vehicle;
      return last != nullptr && last->state.speed < kWaitingSpeed ? last : nullptr;
    }
    return nullptr;
  }

  /// The nearest vehicle whose outline lies in the way of the ego's box along its route, at most
  /// `most` ahead.
  Nearest onRoute(const Vehicle& ego, const map::Route& route, double front, double most) const {
    const double side = 0.5 * ego.dimensions.width + kSideRoom;
    Nearest nearest;
    for (const Vehicle& other : snapshot_.vehicles) {
      const double reach = most + ego.dimensions.length + other.dimensions.length;
      const bool far = (other.state.position - ego.state.position).norm() > reach;
      if (other.id == ego.id || far || traffic::onDifferentLevels(ego, other)) continue;
      for (const Eigen::Vector2d& point : outlineOf(other)) {
        const WayPlace place = placeOnWay(route.path(), point, front, most);
        const bool ahead = place.ahead > 1e-6 || inFront(ego, point);
        if (ahead && place.ahead < most && place.beside < side) nearest.take(other, place.ahead);
      }
    }
    return nearest;
  }

  /// A point relative to a way that goes straight on beyond its end.
  struct WayPlace {
    double ahead = 0.0;   ///< along the way from `front` [m]
    double beside = 0.0;  ///< distance from the way [m]
  };
  static WayPlace placeOnWay(const geometry::Polyline& path, const Eigen::Vector2d& point,
                             double front, double most) {
    const auto place = path.project(point, front, front + most);
    const geometry::Pose2d end = path.extendedPoseAt(path.length());
    const Eigen::Vector2d beyond = end.toBody(point);
    if (path.length() - front > most || beyond.x() <= 0.0)
      return {place.arc_length - front, place.distance};
    return {path.length() - front + beyond.x(), std::abs(beyond.y())};
  }

  static bool inFront(const Vehicle& vehicle, const Eigen::Vector2d& point) {
    return vehicle.state.pose().toBody(point).x() > 0.5 * vehicle.dimensions.length;
  }

  bool isGreen(const std::string& light, int link) const {
    for (const traffic::SignalState& signal : snapshot_.signals) {
      if (signal.id != light) continue;
      if (link < 0 || static_cast<std::size_t>(link) >= signal.state.size()) return true;
      const char letter = signal.state[static_cast<std::size_t>(link)];
      return letter != 'r' && letter != 'u' && letter != 'y';
    }
    return true;
  }

  /// The light that is green for no link of the vehicle's lane; empty where there is none.
  std::string redLight(const Vehicle& vehicle, const map::Lane& lane) const {
    std::string red;
    for (const map::LaneLink& link : linksOf(vehicle, lane)) {
      if (link.signal_id.empty() || isGreen(link.signal_id, link.signal_link)) return "";
      red = link.signal_id;
    }
    return red;
  }

  /// The junction at an arc length; empty outside.
  std::string junctionAt(const map::Route& route, double arc_length) const {
    const map::Lane& lane = network_.lane(route.laneAt(std::min(arc_length, route.length())));
    return lane.internal ? lane.junction_id : "";
  }

  /// The junction that the front is in or within kToLine of.
  std::string junctionAhead(const map::Route& route, double front) const {
    for (const auto& [begin, end] : route.junctionStretches()) {
      if (front < end && begin - front < kToLine)
        return junctionAt(route, std::max(begin, front) + 0.5 * std::min(1.0, end - begin));
    }
    return "";
  }

  map::LaneIndex laneOf(const Vehicle& vehicle) const {
    return vehicle.lane_id.empty() ? map::kNoLane : network_.findLane(vehicle.lane_id);
  }

  /// The nearest vehicle, by its rear, on a lane whose start lies `begin` ahead of the front, and
  /// on those after it; at most `most` ahead.
  void followLanes(const Vehicle& vehicle, map::LaneIndex index, double begin, double most,
                   Nearest& nearest) const {
    const map::Lane& lane = network_.lane(index);
    for (const Vehicle& other : snapshot_.vehicles) {
      if (other.id == vehicle.id || laneOf(other) != index) continue;
      const double gap = begin + lane.centerline.project(other.state.position).arc_length;
      const double free = gap - 0.5 * other.dimensions.length;
      if (gap > 0.0 && free < most) nearest.take(other, free);
    }
    const double end = begin + lane.centerline.length();
    if (end > most || nearest.distance < end) return;
    for (const map::LaneLink& link : linksOf(vehicle, lane))
      followLanes(vehicle, link.to, end, most, nearest);
  }

  /// The vehicle that one at or in a junction most likely lets pass: the nearest in the junction,
  /// else the nearest at another of its entries, whose way meets one of `ways`.
  const Vehicle* inJunction(const Vehicle& vehicle, const std::string& junction,
                            const std::vector<Way>& ways) const {
    if (junction.empty()) return nullptr;
    const map::LaneIndex own = laneOf(vehicle);
    const Eigen::Vector2d front = frontOf(vehicle);
    Nearest inside;
    Nearest entering;
    for (const Vehicle& other : snapshot_.vehicles) {
      const map::LaneIndex index = laneOf(other);
      if (other.id == vehicle.id || index == map::kNoLane) continue;
      const map::Lane& lane = network_.lane(index);
      if (lane.junction_id != junction || !meet(ways, waysFrom(other, index))) continue;
      const double distance = (other.state.position - front).norm();
      if (lane.internal) {
        inside.take(other, distance);
      } else if (own == map::kNoLane || lane.edge_id != network_.lane(own).edge_id) {
        const auto place = lane.centerline.project(frontOf(other));
        if (lane.centerline.length() - place.arc_length < kToEntry) entering.take(other, distance);
      }
    }
    return inside.vehicle != nullptr ? inside.vehicle : entering.vehicle;
  }

  const traffic::TrafficSnapshot& snapshot_;
  const map::RoadNetwork& network_;
  const KnownDemand& demand_;
};

}  // namespace

std::vector<std::string> WaitChain::queue() const {
  std::vector<std::string> vehicles;
  for (const Wait& wait : waits) {
    if (wait.reason != Wait::For::kVehicle || !wait.junction.empty()) break;
    vehicles.push_back(wait.obstacle);
  }
  return vehicles;
}

WaitChain waitChain(const traffic::TrafficSnapshot& snapshot, const map::RoadNetwork& network,
                    const map::Route& ego_route, const KnownDemand& demand) {
  WaitChain chain;
  const Vehicle* vehicle = snapshot.ego();
  if (vehicle == nullptr || ego_route.empty()) return chain;
  const WaitSearch search(snapshot, network, demand);
  chain.waits.push_back(search.ofEgo(*vehicle, ego_route));
  while (chain.waits.back().reason == Wait::For::kVehicle) {
    const std::string next = chain.waits.back().obstacle;
    const auto& waits = chain.waits;
    chain.ring = std::any_of(waits.begin(), waits.end(),
                             [&](const Wait& wait) { return wait.vehicle == next; });
    vehicle = snapshot.find(next);
    if (chain.ring || vehicle == nullptr || vehicle->state.speed > kWaitingSpeed) break;
    chain.waits.push_back(search.of(*vehicle));
  }
  return chain;
}

}  // namespace cdiff::record
