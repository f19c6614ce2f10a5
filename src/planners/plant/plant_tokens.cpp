// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/plant/plant_tokens.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "geometry/simplified.h"
#include "inference/transformer_layers.h"
#include "planners/pdm_lite/route_rules.h"

namespace cdiff::planners {
namespace {

constexpr double kRouteSpacing = 3.5;      // of the points that make segments [m]
constexpr std::size_t kRoutePoints = 50;   // of these
constexpr double kRouteTolerance = 0.5;    // of their simplification [m]
constexpr double kSegmentDistance = 30.0;  // segments that begin farther away do not count [m]
constexpr std::size_t kSegments = 2;       // before and after they are parted
constexpr double kLongestSegment = 10.0;   // [m]
constexpr double kNodeSpacing = 50.0;      // of the sparse route [m]
constexpr double kNearestNode = 7.5;       // [m]

/// A token of a box in the body frame.
PlantToken tokenOf(const Eigen::Vector2d& place, double heading, double speed, double width,
                   double length) {
  return {static_cast<float>(place.x() / kPlantPlaceScale),
          static_cast<float>(place.y() / kPlantPlaceScale),
          static_cast<float>(heading / core::kPi),
          static_cast<float>(speed),
          static_cast<float>(width / kPlantExtentScale),
          static_cast<float>(length / kPlantExtentScale)};
}

}  // namespace

void PlantArchitecture::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"layers", "", "Layers of the transformer's encoder."}, layers, 1, 64);
  visitor.integer({"width", "", "Width of a token."}, width, 16, 4096);
  visitor.integer({"heads", "", "Heads of attention."}, heads, 1, 64);
  visitor.integer({"hidden", "", "Width of the feed-forward networks."}, hidden, 16, 16384);
  visitor.integer({"vehicles", "", "Most vehicle tokens; the nearest are kept."}, vehicles, 1,
                  1024);
  visitor.number({"radius", "m", "Vehicles farther away are no tokens."}, radius, 1.0, 500.0);
  visitor.number({"light_distance", "m", "A light counts up to this far before its stop line."},
                 light_distance, 1.0, 500.0);
  visitor.flag(
      {"own_vehicle", "", "The driven vehicle is a token, too, so that its speed is known."},
      own_vehicle);
}

void PlantArchitecture::validate() const {
  inference::TransformerSizes{width, heads, hidden}.validate();
}

PlantToken plantToken(const geometry::Pose2d& frame, const traffic::VehicleState& state,
                      const traffic::VehicleDimensions& size) {
  return tokenOf(frame.toBody(state.position), core::angleDifference(state.heading, frame.heading),
                 state.speed / kPlantSpeedScale, size.width, size.length);
}

namespace {

/// Squared distances with places in the snapshot, nearest first.
std::vector<std::pair<double, std::size_t>> nearestFirst(const PlantArchitecture& architecture,
                                                         const traffic::TrafficSnapshot& snapshot,
                                                         const traffic::Vehicle& vehicle) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < snapshot.vehicles.size(); ++i) {
    const traffic::Vehicle& other = snapshot.vehicles[i];
    const bool left_out = other.id == vehicle.id && !architecture.own_vehicle;
    if (left_out || traffic::onDifferentLevels(vehicle, other)) continue;
    const double distance = (other.state.position - vehicle.state.position).norm();
    if (distance <= architecture.radius) near.emplace_back(distance, i);
  }
  std::sort(near.begin(), near.end(), [&](const auto& left, const auto& right) {
    if (left.first != right.first) return left.first < right.first;
    return snapshot.vehicles[left.second].id < snapshot.vehicles[right.second].id;
  });
  const auto most = static_cast<std::size_t>(architecture.vehicles);
  if (near.size() > most) near.resize(most);
  return near;
}

}  // namespace

PlantInput plantInput(const PlantArchitecture& architecture,
                      const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& vehicle,
                      const map::Route& route, double arc_length) {
  const geometry::Pose2d pose = vehicle.state.pose();
  PlantInput input;
  for (const auto& [distance, index] : nearestFirst(architecture, snapshot, vehicle)) {
    const traffic::Vehicle& other = snapshot.vehicles[index];
    input.vehicles.push_back(plantToken(pose, other.state, other.dimensions));
    input.ids.push_back(other.id);
  }
  input.route = plantRoute(pose, vehicle.dimensions.width, route, arc_length);
  const auto light = distanceToRedLight(route, arc_length, snapshot);
  input.red_light = light && *light <= architecture.light_distance;
  const Eigen::Vector2d target = pose.toBody(plantTargetPoint(route, arc_length));
  input.target = {static_cast<float>(target.x() / kPlantPlaceScale),
                  static_cast<float>(target.y() / kPlantPlaceScale)};
  return input;
}

namespace {

/// Points of the route ahead, in the map frame; fewer than two where it has ended.
std::vector<Eigen::Vector2d> routeAhead(const map::Route& route, double arc_length) {
  std::vector<Eigen::Vector2d> points;
  double s = arc_length;
  for (; s < route.length() && points.size() < kRoutePoints; s += kRouteSpacing)
    points.push_back(route.path().positionAt(s));
  const bool ended = s >= route.length() && points.size() < kRoutePoints;
  if (ended && !points.empty()) points.push_back(route.path().positionAt(route.length()));
  return geometry::simplified(points, kRouteTolerance);
}

}  // namespace

std::vector<PlantToken> plantRoute(const geometry::Pose2d& pose, double width,
                                   const map::Route& route, double arc_length) {
  const std::vector<Eigen::Vector2d> points = routeAhead(route, arc_length);
  std::vector<PlantToken> tokens;
  for (std::size_t i = 0; i + 1 < points.size() && i < kSegments; ++i) {
    if ((points[i] - pose.position).norm() > kSegmentDistance) break;
    const Eigen::Vector2d whole = points[i + 1] - points[i];
    const double parts = std::max(1.0, std::ceil(whole.norm() / kLongestSegment));
    const Eigen::Vector2d step = whole / parts;
    const double heading = core::angleDifference(std::atan2(step.y(), step.x()), pose.heading);
    for (double part = 0.0; part < parts && tokens.size() < kSegments; part += 1.0) {
      const Eigen::Vector2d middle = pose.toBody(points[i] + (part + 0.5) * step);
      tokens.push_back(
          tokenOf(middle, heading, static_cast<double>(tokens.size()), width, step.norm()));
    }
  }
  return tokens;
}

Eigen::Vector2d plantTargetPoint(const map::Route& route, double arc_length) {
  const double nearest = arc_length + kNearestNode;
  double node = kNodeSpacing * (std::floor(nearest / kNodeSpacing) + 1.0);
  for (const auto& [begin, end] : route.junctionStretches()) {
    for (const double border : {begin, end}) {
      if (border > nearest) node = std::min(node, border);
    }
  }
  return route.path().positionAt(std::min(node, route.length()));
}

}  // namespace cdiff::planners
