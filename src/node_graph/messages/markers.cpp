// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/markers.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/planning/perception.h"
#include "node_graph/messages/perceived_conversions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kLifetime = 0.5;  // [s] of simulated time
constexpr double kLift = 0.05;     // [m] above the road, so that lines stay visible

struct Color {
  float red;
  float green;
  float blue;
  float alpha;
};
constexpr Color kEgoColor{0.86F, 0.15F, 0.15F, 1.0F};
constexpr Color kCbvColor{0.55F, 0.20F, 0.75F, 1.0F};
constexpr Color kBackgroundColor{0.25F, 0.45F, 0.85F, 0.9F};
constexpr Color kLaneColor{0.55F, 0.55F, 0.55F, 1.0F};
constexpr Color kJunctionColor{0.75F, 0.65F, 0.35F, 1.0F};
constexpr Color kEgoRouteColor{0.90F, 0.45F, 0.45F, 0.8F};
constexpr Color kConflictColor{1.0F, 0.80F, 0.10F, 1.0F};
constexpr Color kRolloutColor{0.20F, 0.90F, 0.40F, 1.0F};
constexpr Color kLabelColor{1.0F, 1.0F, 1.0F, 1.0F};

Marker makeMarker(const std::string& marker_namespace, int id, int type, const Color& color) {
  Marker marker;
  marker.header.frame_id = frameId(kMapFrame);
  marker.ns = marker_namespace;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color.r = color.red;
  marker.color.g = color.green;
  marker.color.b = color.blue;
  marker.color.a = color.alpha;
  return marker;
}

Marker deleteAll() {
  Marker marker = makeMarker("", 0, Marker::CUBE, kLaneColor);
  marker.action = Marker::DELETEALL;
  return marker;
}

geometry_msgs::Point toPoint(const Eigen::Vector3d& position) {
  geometry_msgs::Point point;
  point.x = position.x();
  point.y = position.y();
  point.z = position.z() + kLift;
  return point;
}

/// Both borders of a lane, as pairs of points.
void addBorders(const map::Lane& lane, std::vector<geometry_msgs::Point>& pairs) {
  const auto& points = lane.centerline.points();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Eigen::Vector2d along = (points[i + 1] - points[i]).head<2>().normalized();
    const Eigen::Vector2d side = 0.5 * lane.width * geometry::leftNormal(along);
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d offset(sign * side.x(), sign * side.y(), 0.0);
      pairs.push_back(toPoint(points[i] + offset));
      pairs.push_back(toPoint(points[i + 1] + offset));
    }
  }
}

Marker laneMarker(const map::RoadNetwork& network) {
  Marker marker = makeMarker("lanes", 0, Marker::LINE_LIST, kLaneColor);
  marker.scale.x = 0.12;
  for (const map::Lane& lane : network.lanes()) {
    if (lane.allows_cars && !lane.internal) addBorders(lane, marker.points);
  }
  return marker;
}

Marker junctionMarker(const map::RoadNetwork& network) {
  Marker marker = makeMarker("junctions", 0, Marker::LINE_LIST, kJunctionColor);
  marker.scale.x = 0.12;
  for (const map::Junction& junction : network.junctions()) {
    for (std::size_t i = 0; i < junction.shape.size(); ++i) {
      marker.points.push_back(toPoint(junction.shape[i]));
      marker.points.push_back(toPoint(junction.shape[(i + 1) % junction.shape.size()]));
    }
  }
  return marker;
}

Marker routeMarker(const std::string& marker_namespace, int id, const map::Route& route,
                   const Color& color) {
  Marker marker = makeMarker(marker_namespace, id, Marker::LINE_STRIP, color);
  marker.scale.x = 0.4;
  for (const Eigen::Vector3d& point : route.path().points())
    marker.points.push_back(toPoint(point));
  return marker;
}

const Color& colorOf(traffic::VehicleRole role) {
  if (role == traffic::VehicleRole::kEgo) return kEgoColor;
  return role == traffic::VehicleRole::kCbv ? kCbvColor : kBackgroundColor;
}

Marker vehicleMarker(const traffic::Vehicle& vehicle, int id) {
  Marker marker = makeMarker("vehicles", id, Marker::CUBE, colorOf(vehicle.role));
  marker.pose.position.x = vehicle.state.position.x();
  marker.pose.position.y = vehicle.state.position.y();
  marker.pose.position.z = vehicle.state.elevation + 0.5 * vehicle.dimensions.height;
  marker.pose.orientation.z = std::sin(0.5 * vehicle.state.heading);
  marker.pose.orientation.w = std::cos(0.5 * vehicle.state.heading);
  marker.scale.x = vehicle.dimensions.length;
  marker.scale.y = vehicle.dimensions.width;
  marker.scale.z = vehicle.dimensions.height;
  return marker;
}

Marker labelMarker(const traffic::Vehicle& vehicle, int id) {
  Marker marker = makeMarker("labels", id, Marker::TEXT_VIEW_FACING, kLabelColor);
  marker.pose.position.x = vehicle.state.position.x();
  marker.pose.position.y = vehicle.state.position.y();
  marker.pose.position.z = vehicle.state.elevation + vehicle.dimensions.height + 1.0;
  marker.scale.z = 1.2;
  marker.text = vehicle.id;
  return marker;
}

Marker conflictMarker(const cbv::CbvAssignment& assignment) {
  Marker marker = makeMarker("conflict_points", assignment.slot, Marker::SPHERE, kConflictColor);
  marker.pose.position = toPoint(assignment.conflict_point.position);
  return marker;
}

}  // namespace

visualization_msgs::MarkerArray mapMarkers(const session::SessionSetup& setup) {
  visualization_msgs::MarkerArray array;
  array.markers = {deleteAll(), laneMarker(setup.network()), junctionMarker(setup.network()),
                   routeMarker("ego_route", 0, setup.egoRoute(), kEgoRouteColor)};
  return array;
}

namespace {

/// Boxes of the standard size: a report does not hold the ego's.
Marker ghostMarker(const planning::PlannedAction& action) {
  const guidance::ChallengeReport& report = action.guidance.challenge;
  traffic::Vehicle ghost;
  ghost.state = report.ghost.value_or(ghost.state);
  Marker marker = vehicleMarker(ghost, action.slot);
  marker.ns = "ghosts";
  marker.color.r = marker.color.g = marker.color.b = 1.0F;
  marker.color.a = 0.4F;
  if (!report.ghost) marker.action = Marker::DELETE;
  return marker;
}

Marker challengeMarker(const planning::PlannedAction& action) {
  const guidance::ChallengeReport& report = action.guidance.challenge;
  traffic::Vehicle place;
  if (!action.rollout.empty()) place.state = action.rollout.front().state;
  place.state.elevation += 2.0 * place.dimensions.height;  // above the label of the vehicle
  Marker marker = labelMarker(place, action.slot);
  marker.ns = "challenge";
  marker.text = report.state;
  if (!report.reason.empty()) marker.text += ": " + report.reason;
  if (report.ghost && report.last_brake_time)
    marker.text += ", brake within " + core::formatFixed(*report.last_brake_time, 1) + " s";
  if (report.state.empty()) marker.action = Marker::DELETE;
  return marker;
}

}  // namespace

MarkerArray rolloutMarkers(const std::vector<planning::PlannedAction>& actions, double time) {
  constexpr double kRolloutLift = 0.3;  // [m] above the route
  MarkerArray array;
  for (const planning::PlannedAction& action : actions) {
    Marker marker = makeMarker("rollouts", action.slot, Marker::LINE_STRIP, kRolloutColor);
    if (action.rollout.size() < 2) marker.action = Marker::DELETE;  // a line needs two points
    marker.header.stamp = toStamp(time);
    marker.lifetime = ros::Duration(kLifetime);
    marker.scale.x = 0.5;
    for (const planning::RolloutPoint& point : action.rollout) {
      const Eigen::Vector2d& position = point.state.position;
      marker.points.push_back(
          toPoint({position.x(), position.y(), point.state.elevation + kRolloutLift}));
    }
    array.markers.push_back(marker);
    for (Marker challenge : {ghostMarker(action), challengeMarker(action)}) {
      challenge.header.stamp = toStamp(time);
      challenge.lifetime = ros::Duration(kLifetime);
      if (!action.guidance.challenge.state.empty()) array.markers.push_back(challenge);
    }
  }
  return array;
}

namespace {

constexpr Color kPerceivedColor{1.0F, 0.55F, 0.0F, 1.0F};
constexpr Color kForecastColor{1.0F, 0.85F, 0.30F, 1.0F};
constexpr Color kOccupiedColor{0.90F, 0.20F, 0.55F, 1.0F};
constexpr double kPerceivedLift = 0.2;  // [m] above the road

Color lineColor(const std::string& kind) {
  if (kind == "edge") return {0.95F, 0.25F, 0.20F, 1.0F};
  return kind == "divider" ? Color{0.95F, 0.95F, 0.95F, 1.0F} : Color{0.20F, 0.75F, 0.90F, 1.0F};
}

/// A line from point to point, as pairs.
void addPairs(const std::vector<Eigen::Vector2d>& line, double z, Marker& marker) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    marker.points.push_back(toPoint({line[i].x(), line[i].y(), z}));
    marker.points.push_back(toPoint({line[i + 1].x(), line[i + 1].y(), z}));
  }
}

Marker perceivedVehicleMarker(const planning::PerceivedVehicle& seen, int id) {
  traffic::Vehicle vehicle;
  vehicle.state = seen.state;
  vehicle.dimensions = seen.dimensions;
  Marker marker = vehicleMarker(vehicle, id);
  marker.ns = "perceived_vehicles";
  marker.color.r = kPerceivedColor.red;
  marker.color.g = kPerceivedColor.green;
  marker.color.b = kPerceivedColor.blue;
  marker.color.a = static_cast<float>(seen.score);
  return marker;
}

Marker forecastMarker(const planning::Perception& perception, double z) {
  Marker marker = makeMarker("forecasts", 0, Marker::LINE_LIST, kForecastColor);
  marker.scale.x = 0.3;
  for (const planning::PerceivedVehicle& vehicle : perception.vehicles) {
    if (vehicle.forecasts.empty()) continue;
    std::vector<Eigen::Vector2d> way = planning::likeliest(vehicle.forecasts).places;
    way.insert(way.begin(), vehicle.state.position);
    addPairs(way, z, marker);
  }
  return marker;
}

Marker perceivedLineMarker(const planning::PerceivedLine& line, int id, double z) {
  Marker marker = makeMarker("perceived_lines", id, Marker::LINE_LIST, lineColor(line.kind));
  marker.scale.x = 0.25;
  addPairs(line.points, z, marker);
  return marker;
}

Marker occupancyMarker(const planning::PerceivedOccupancy& occupancy, int id, double z) {
  Marker marker = makeMarker("occupancy", id, Marker::CUBE_LIST, kOccupiedColor);
  marker.color.a = static_cast<float>(1.0 / (1.0 + occupancy.time));
  marker.pose.orientation.z = std::sin(0.5 * occupancy.frame.heading);
  marker.pose.orientation.w = std::cos(0.5 * occupancy.frame.heading);
  marker.pose.position = toPoint({occupancy.frame.position.x(), occupancy.frame.position.y(), z});
  marker.scale.x = marker.scale.y = occupancy.cell;
  marker.scale.z = 0.1;
  for (const Eigen::Vector2d& center : planning::occupiedCells(occupancy)) {
    marker.points.emplace_back();
    marker.points.back().x = center.x();
    marker.points.back().y = center.y();
  }
  return marker;
}

}  // namespace

MarkerArray perceptionMarkers(const planning::Perception& perception, double elevation,
                              double time) {
  const double z = elevation + kPerceivedLift;
  MarkerArray array;
  for (const planning::PerceivedVehicle& vehicle : perception.vehicles)
    array.markers.push_back(
        perceivedVehicleMarker(vehicle, static_cast<int>(array.markers.size())));
  for (const planning::PerceivedLine& line : perception.lines)
    array.markers.push_back(perceivedLineMarker(line, static_cast<int>(array.markers.size()), z));
  for (const planning::PerceivedOccupancy& occupancy : perception.occupancy)
    array.markers.push_back(occupancyMarker(occupancy, static_cast<int>(array.markers.size()), z));
  array.markers.push_back(forecastMarker(perception, z));
  for (Marker& marker : array.markers) {
    marker.header.stamp = toStamp(time);
    marker.lifetime = ros::Duration(kLifetime);
  }
  array.markers.erase(std::remove_if(array.markers.begin(), array.markers.end(),
                                     [](const Marker& marker) {
                                       const bool list = marker.type == Marker::LINE_LIST ||
                                                         marker.type == Marker::CUBE_LIST;
                                       return list && marker.points.empty();
                                     }),
                      array.markers.end());
  array.markers.insert(array.markers.begin(), deleteAll());
  return array;
}

int SessionMarkers::idOf(const std::string& vehicle_id) {
  return ids_.try_emplace(vehicle_id, static_cast<int>(ids_.size())).first->second;
}

visualization_msgs::MarkerArray SessionMarkers::build(const traffic::TrafficSnapshot& snapshot,
                                                      const cbv::CbvSelection* selection) {
  visualization_msgs::MarkerArray array;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    array.markers.push_back(vehicleMarker(vehicle, idOf(vehicle.id)));
    if (vehicle.role == traffic::VehicleRole::kBackground) continue;
    array.markers.push_back(labelMarker(vehicle, idOf(vehicle.id)));
  }
  if (selection != nullptr) {
    for (const cbv::CbvAssignment& assignment : selection->assignments) {
      array.markers.push_back(conflictMarker(assignment));
      if (assignment.conflict_aware_route.empty()) continue;
      array.markers.push_back(routeMarker("conflict_aware_routes", assignment.slot,
                                          assignment.conflict_aware_route, kCbvColor));
    }
  }
  for (Marker& marker : array.markers) {
    marker.header.stamp = toStamp(snapshot.time);
    marker.lifetime = ros::Duration(kLifetime);
  }
  if (first_) array.markers.insert(array.markers.begin(), deleteAll());
  first_ = false;
  return array;
}

}  // namespace cdiff::node_graph
