// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/places.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/route_source.h"

namespace cdiff::storyboard {
namespace {

using core::InputError;
using Kind = Position::Kind;

constexpr double kRouteLength = 2000.0;  // [m]

Eigen::Vector3d pointOf(const MapPose& place) {
  return {place.pose.position.x(), place.pose.position.y(), place.elevation};
}

bool drivesForward(int lane) { return lane <= 0; }

/// The id of a lane so many lanes to the left of another, as its driver sees it; 0 is no lane.
int laneBeside(int lane, int left) {
  const int toward = drivesForward(lane) ? 1 : -1;
  int found = lane;
  for (int i = 0; i < std::abs(left); ++i) {
    found += left > 0 ? toward : -toward;
    if (found == 0) found += left > 0 ? toward : -toward;
  }
  return found;
}

/// The lane that follows: straight on where it can.
map::LaneIndex laneAfter(const map::Lane& lane) {
  for (const map::LaneLink& link : lane.next)
    if (link.direction == 's') return link.to;
  return lane.next.empty() ? map::kNoLane : lane.next.front().to;
}

/// A place on the lanes so far ahead, or behind for a negative distance; clamped where lanes end.
map::LanePosition along(const map::RoadNetwork& network, map::LanePosition place, double ahead) {
  constexpr int kMostLanes = 1000;
  place.arc_length += ahead;
  for (int i = 0; i < kMostLanes; ++i) {
    const map::Lane& lane = network.lane(place.lane);
    const double length = lane.centerline.length();
    if (place.arc_length > length && laneAfter(lane) != map::kNoLane) {
      place = {laneAfter(lane), place.arc_length - length};
    } else if (place.arc_length < 0.0 && !lane.previous.empty()) {
      const map::LaneIndex before = lane.previous.front();
      place = {before, place.arc_length + network.lane(before).centerline.length()};
    } else {
      break;
    }
  }
  const double length = network.lane(place.lane).centerline.length();
  place.arc_length = std::clamp(place.arc_length, 0.0, length);
  return place;
}

}  // namespace

const map::OpenDriveRoads& Places::roads(const std::string& what) const {
  if (roads_) return *roads_;
  throw InputError(what + " needs a road network in OpenDRIVE, which this one is not");
}

MapPose Places::onRoad(const std::string& road, double s, double t) const {
  const map::OpenDriveRoads& known = roads("a position on a road");
  geometry::Pose2d pose = known.poseAt(road, s, t);
  pose.position += graph_.network().netOffset();
  return {pose, known.elevationAt(road, s)};
}

MapPose Places::lanePose(const std::string& road, int lane, double s, double offset) const {
  const double center = roads("a position on a lane").laneCenter(road, lane, s);
  MapPose place = onRoad(road, s, center + offset);
  if (!drivesForward(lane)) place.pose.heading += core::kPi;
  return place;
}

map::RoadPlace Places::roadPlace(const MapPose& place) const {
  const auto found = roads("a lane by its id")
                         .locate(place.pose.position - graph_.network().netOffset(),
                                 place.elevation, place.pose.heading);
  if (found) return *found;
  throw InputError("there is no lane at (" + core::formatFixed(place.pose.position.x(), 1) + ", " +
                   core::formatFixed(place.pose.position.y(), 1) + ")");
}

std::optional<map::LanePosition> Places::laneAt(const MapPose& place) const {
  constexpr double kReach = 3.0;       // [m]
  constexpr double kMostTurned = 1.2;  // [rad]
  for (const map::LaneMatch& match : graph_.network().lanesNear(
           place.pose.position, place.elevation, kReach, place.pose.heading)) {
    if (std::abs(match.heading_difference) < kMostTurned)
      return map::LanePosition{match.lane, match.projection.arc_length};
  }
  return std::nullopt;
}

double Places::laneHeading(const MapPose& place) const {
  const auto lane = laneAt(place);
  if (!lane) return place.pose.heading;
  return graph_.network().lane(lane->lane).centerline.headingAt(lane->arc_length);
}

MapPose Places::relativeToLane(const Position& position, const MapPose& reference) const {
  auto place = laneAt(reference);
  if (!place) throw InputError("'" + position.entity + "' is on no lane");
  const map::RoadNetwork& network = graph_.network();
  MapPose beside = reference;
  if (position.lane != 0) {
    const map::RoadPlace road = roadPlace(reference);
    beside = lanePose(road.road, laneBeside(road.lane, position.lane), road.s, 0.0);
    place = laneAt(beside);
    if (!place) throw InputError("there is no lane beside '" + position.entity + "'");
  }
  const bool against =
      std::abs(core::angleDifference(beside.pose.heading, reference.pose.heading)) > 1.6;
  const map::LanePosition found = along(network, *place, against ? -position.s : position.s);
  const geometry::Polyline& line = network.lane(found.lane).centerline;
  MapPose pose{line.extendedPoseAt(found.arc_length), line.pointAt(found.arc_length).z()};
  pose.pose.position = pose.pose.toMap({0.0, position.t});
  return pose;
}

MapPose Places::relativeToRoad(const Position& position, const MapPose& reference) const {
  const map::RoadPlace road = roadPlace(reference);
  MapPose place = onRoad(road.road, road.s + position.s, road.t + position.t);
  if (!drivesForward(road.lane)) place.pose.heading += core::kPi;
  return place;
}

/// With a lane, abreast of the route in that lane of the same road.
MapPose Places::onRoute(const Position& position, const PoseOf& pose_of) const {
  const MapPose start = resolve(position.route.front(), pose_of);
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 1; i < position.route.size(); ++i)
    points.push_back(pointOf(resolve(position.route[i], pose_of)));
  const map::Route route = routeThrough(start, std::move(points));
  const geometry::Polyline& path = route.path();
  MapPose place{path.extendedPoseAt(position.s), path.pointAt(position.s).z()};
  if (position.lane != 0) {
    const map::RoadPlace road = roadPlace(place);
    return lanePose(road.road, position.lane, road.s, position.t);
  }
  place.pose.position = place.pose.toMap({0.0, position.t});
  return place;
}

/// In the axes of the entity or in those of the world.
MapPose Places::relativeToEntity(const Position& position, MapPose place) {
  const Eigen::Vector2d difference = position.point.head<2>();
  const bool turned = position.kind == Kind::kObject;
  place.pose.position =
      turned ? place.pose.toMap(difference) : Eigen::Vector2d(place.pose.position + difference);
  place.elevation += position.point.z();
  return place;
}

MapPose Places::withoutOwnHeading(const Position& position, const PoseOf& pose_of) const {
  const Eigen::Vector3d& point = position.point;
  switch (position.kind) {
    case Kind::kLane:
      return lanePose(position.road, position.lane, position.s, position.t);
    case Kind::kRoad:
      return onRoad(position.road, position.s, position.t);
    case Kind::kRoute:
      return onRoute(position, pose_of);
    case Kind::kRelativeLane:
      return relativeToLane(position, pose_of(position.entity));
    case Kind::kRelativeRoad:
      return relativeToRoad(position, pose_of(position.entity));
    case Kind::kObject:
    case Kind::kRelativeWorld:
      return relativeToEntity(position, pose_of(position.entity));
    case Kind::kWorld:
      break;
  }
  MapPose place{{point.head<2>() + graph_.network().netOffset(), 0.0}, point.z()};
  if (!position.level) {
    const auto near = graph_.network().lanesNear(place.pose.position, 5.0);
    if (!near.empty()) place.elevation = near.front().projection.elevation;
  }
  return place;
}

MapPose Places::resolve(const Position& position, const PoseOf& pose_of) const {
  try {
    MapPose place = withoutOwnHeading(position, pose_of);
    const double base = position.absolute_heading ? 0.0 : place.pose.heading;
    if (position.oriented || position.kind == Kind::kWorld)
      place.pose.heading = base + position.heading;
    place.pose.heading = core::wrapAngle(place.pose.heading);
    return place;
  } catch (const InputError& error) {
    const std::string text = error.what();
    const bool placed = text.rfind(position.source.file + ":", 0) == 0;
    throw InputError((placed ? "" : position.source.text() + ": ") + text);
  }
}

Eigen::Vector2d Places::laneTarget(const LaneChangeAction& change, const MapPose& self,
                                   const MapPose& reference, double offset) const {
  const map::RoadPlace own = roadPlace(self);
  const int lane =
      change.entity.empty() ? change.lane : laneBeside(roadPlace(reference).lane, change.lane);
  return lanePose(own.road, lane, own.s, offset).pose.position;
}

std::optional<map::Route> Places::routeFrom(const MapPose& place) const {
  constexpr double kShortest = 1.0;  // [m]
  const auto found = laneAt(place);
  if (!found) return std::nullopt;
  const double length = graph_.network().lane(found->lane).centerline.length();
  const double start = std::clamp(found->arc_length, 0.0, std::max(0.0, length - kShortest));
  return graph_.extended(graph_.toRoute({{found->lane}, length - start}, start, length),
                         kRouteLength);
}

map::Route Places::prolonged(const map::Route& route) const {
  return graph_.extended(route, route.length() + kRouteLength);
}

/// Whether the way from a point to the next leads past a place.
bool Places::leadsPast(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                       const Eigen::Vector2d& place) const {
  constexpr double kBeside = 2.0;  // [m]
  const map::Route way = map::routeThroughPoints(graph_, {from, to});
  const geometry::Projection found = way.path().project(place);
  return (way.path().pointAt(found.arc_length).head<2>() - place).norm() < kBeside &&
         found.arc_length > 0.0;
}

map::Route Places::routeThrough(const MapPose& place, std::vector<Eigen::Vector3d> points) const {
  while (points.size() > 1 && leadsPast(points[0], points[1], place.pose.position))
    points.erase(points.begin());
  points.insert(points.begin(), pointOf(place));
  return graph_.extended(map::routeThroughPoints(graph_, points), kRouteLength);
}

bool Places::isOnLane(const MapPose& place) const {
  constexpr double kReach = 5.0;  // [m]
  const auto near = graph_.network().lanesNear(place.pose.position, place.elevation, kReach);
  return std::any_of(near.begin(), near.end(), [&](const map::LaneMatch& match) {
    const map::Lane& lane = graph_.network().lane(match.lane);
    return std::abs(match.projection.lateral_offset) <= 0.5 * lane.width;
  });
}

bool Places::isEndOfRoad(const MapPose& place) const {
  constexpr double kNear = 0.5;  // [m]
  const auto found = laneAt(place);
  if (!found) return false;
  const map::Lane& lane = graph_.network().lane(found->lane);
  return lane.next.empty() && lane.centerline.length() - found->arc_length < kNear;
}

}  // namespace cdiff::storyboard
