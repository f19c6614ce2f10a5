// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/plan_markers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "e2e_cdiff/planning/perception.h"
#include "guidance/objective_registry.h"

namespace cdiff::node_graph {
namespace {

using planning::PlannedAction;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;
using Markers = std::vector<Marker>;

constexpr double kPlanLift = 0.3;       // [m] above the road: above routes and trails
constexpr double kCandidateLift = 0.2;  // [m]
constexpr std::size_t kPointsPerSecond = 10;

Eigen::Vector3d placeOf(const planning::RolloutPoint& point, double lift) {
  const Eigen::Vector2d& position = point.state.position;
  return {position.x(), position.y(), point.state.elevation + lift};
}

void addRollout(const PlannedAction& action, Markers& markers) {
  const MarkerColor color = planColor(action);
  Marker line = makeMarker("rollouts", action.slot, Marker::LINE_STRIP, color);
  line.scale.x = 0.7;
  Marker dots = makeMarker("rollout_seconds", action.slot, Marker::SPHERE_LIST, color);
  dots.scale.x = dots.scale.y = 1.1;
  dots.scale.z = 0.2;
  for (std::size_t i = 0; i < action.rollout.size(); ++i) {
    line.points.push_back(toMarkerPoint(placeOf(action.rollout[i], kPlanLift)));
    if ((i + 1) % kPointsPerSecond == 0) dots.points.push_back(line.points.back());
  }
  markers.push_back(line);
  if (!dots.points.empty()) markers.push_back(dots);
}

void addCandidates(const PlannedAction& action, Markers& markers) {
  if (action.candidates.empty()) return;
  double worst = std::numeric_limits<double>::infinity();
  double best = -worst;
  for (const planning::PlannedCandidate& candidate : action.candidates) {
    if (!std::isfinite(candidate.score)) continue;
    worst = std::min(worst, candidate.score);
    best = std::max(best, candidate.score);
  }
  Marker lines = makeMarker("plan_candidates", action.slot, Marker::LINE_LIST, {});
  lines.scale.x = 0.18;
  const double z =
      kCandidateLift + (action.rollout.empty() ? 0.0 : action.rollout.front().state.elevation);
  for (const planning::PlannedCandidate& candidate : action.candidates) {
    const bool ranked = std::isfinite(candidate.score) && best > worst;
    const double share = ranked ? (candidate.score - worst) / (best - worst) : 0.0;
    MarkerColor color = planColor(action);
    color.alpha = static_cast<float>(0.35 + 0.65 * share);
    for (std::size_t i = 1; i < candidate.places.size(); ++i) {
      const Eigen::Vector2d& from = candidate.places[i - 1];
      const Eigen::Vector2d& to = candidate.places[i];
      addSegment(lines, {from.x(), from.y(), z}, {to.x(), to.y(), z}, color);
    }
  }
  if (!lines.points.empty()) markers.push_back(lines);
}

/// A line to each vehicle that got attention, the broader the more.
void addAttention(const PlannedAction& action, const traffic::TrafficSnapshot& snapshot, int& id,
                  Markers& markers) {
  constexpr double kWidest = 1.2;  // [m]
  constexpr double kLeast = 0.02;  // share of the attention
  const traffic::Vehicle* from = snapshot.find(action.vehicle_id);
  if (from == nullptr) return;
  for (const planning::AttendedVehicle& attended : action.attended) {
    const traffic::Vehicle* to = snapshot.find(attended.vehicle_id);
    if (to == nullptr || to == from || attended.weight < kLeast) continue;
    Marker line = makeMarker("attention", id++, Marker::LINE_STRIP, marker_color::kUnguided);
    line.color.a = 0.6F;
    line.scale.x = kWidest * attended.weight;
    line.points = {toMarkerPoint(onVehicle(*from, {0.0, 0.0, 1.0})),
                   toMarkerPoint(onVehicle(*to, {0.0, 0.0, 1.0}))};
    markers.push_back(line);
  }
}

/// Boxes of the standard size: a report does not hold the ego's.
void addGhost(const PlannedAction& action, Markers& markers) {
  const guidance::ChallengeReport& report = action.guidance.challenge;
  if (!report.ghost) return;
  traffic::Vehicle ghost;
  ghost.state = *report.ghost;
  markers.push_back(boxMarker("ghosts", action.slot, ghost, {1.0F, 1.0F, 1.0F, 0.4F}));
}

}  // namespace

MarkerColor objectiveColor(const std::string& objective) {
  constexpr MarkerColor kObjectives[] = {{0.20F, 0.85F, 1.0F, 1.0F},  {0.95F, 0.75F, 0.30F, 1.0F},
                                         {0.55F, 0.95F, 0.25F, 1.0F}, {1.0F, 0.30F, 0.55F, 1.0F},
                                         {0.75F, 0.85F, 0.55F, 1.0F}, {0.60F, 0.65F, 1.0F, 1.0F},
                                         {0.95F, 0.95F, 0.60F, 1.0F}, {0.80F, 0.80F, 0.80F, 1.0F}};
  const std::vector<std::string> names = guidance::objectiveNames();
  const auto found = std::find(names.begin(), names.end(), objective);
  if (found == names.end()) return marker_color::kUnguided;
  return kObjectives[static_cast<std::size_t>(found - names.begin()) % std::size(kObjectives)];
}

std::string strongestObjective(const guidance::GuidanceReport& report) {
  std::string strongest;
  double pull = 0.0;
  for (const guidance::ObjectiveReport& objective : report.objectives) {
    if (!(objective.gradient_norm > pull)) continue;
    pull = objective.gradient_norm;
    strongest = objective.name;
  }
  return strongest;
}

MarkerColor planColor(const PlannedAction& action) {
  if (action.slot == traffic::kEgoSlot) return marker_color::kContact;
  return objectiveColor(strongestObjective(action.guidance));
}

std::string intentionText(const PlannedAction& action) {
  const double horizon = traffic::kRolloutStep * static_cast<double>(action.rollout.size());
  std::string text = "plan of " + action.vehicle_id + ": " +
                     core::formatFixed(action.rollout.back().state.speed, 1) + " m/s in " +
                     core::formatFixed(horizon, 1) + " s";
  const std::string objective = strongestObjective(action.guidance);
  if (!objective.empty()) text += ", pulled by " + objective;
  return text;
}

std::string challengeText(const PlannedAction& action) {
  const guidance::ChallengeReport& report = action.guidance.challenge;
  std::string text = report.state;
  if (!report.reason.empty()) text += ": " + report.reason;
  if (report.ghost && report.last_brake_time)
    text += ", brake within " + core::formatFixed(*report.last_brake_time, 1) + " s";
  return text;
}

MarkerArray planMarkers(const std::vector<PlannedAction>& actions,
                        const traffic::TrafficSnapshot& snapshot) {
  MarkerArray array;
  int attended = 0;
  for (const PlannedAction& action : actions) {
    addCandidates(action, array.markers);
    if (action.rollout.size() >= 2) addRollout(action, array.markers);  // a line needs two points
    addAttention(action, snapshot, attended, array.markers);
    addGhost(action, array.markers);
  }
  dateMarkers(array.markers, snapshot.time);
  return array;
}

namespace {

constexpr MarkerColor kPerceivedColor{1.0F, 0.55F, 0.0F, 1.0F};
constexpr MarkerColor kForecastColor{1.0F, 0.85F, 0.30F, 1.0F};
constexpr MarkerColor kOccupiedColor{0.90F, 0.20F, 0.55F, 1.0F};
constexpr double kPerceivedLift = 0.2;  // [m] above the road

MarkerColor lineColor(const std::string& kind) {
  if (kind == "edge") return {0.95F, 0.25F, 0.20F, 1.0F};
  return kind == "divider" ? MarkerColor{0.95F, 0.95F, 0.95F, 1.0F}
                           : MarkerColor{0.20F, 0.75F, 0.90F, 1.0F};
}

/// A line from point to point, as pairs.
void addPairs(const std::vector<Eigen::Vector2d>& line, double z, Marker& marker) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    marker.points.push_back(toMarkerPoint({line[i].x(), line[i].y(), z}));
    marker.points.push_back(toMarkerPoint({line[i + 1].x(), line[i + 1].y(), z}));
  }
}

Marker perceivedVehicleMarker(const planning::PerceivedVehicle& seen, int id) {
  traffic::Vehicle vehicle;
  vehicle.state = seen.state;
  vehicle.dimensions = seen.dimensions;
  MarkerColor color = kPerceivedColor;
  color.alpha = static_cast<float>(seen.score);
  return boxMarker("perceived_vehicles", id, vehicle, color);
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
  marker.pose.position =
      toMarkerPoint({occupancy.frame.position.x(), occupancy.frame.position.y(), z});
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
  dateMarkers(array.markers, time);
  array.markers.erase(std::remove_if(array.markers.begin(), array.markers.end(),
                                     [](const Marker& marker) {
                                       const bool list = marker.type == Marker::LINE_LIST ||
                                                         marker.type == Marker::CUBE_LIST;
                                       return list && marker.points.empty();
                                     }),
                      array.markers.end());
  array.markers.insert(array.markers.begin(), deleteAllMarkers());
  return array;
}

}  // namespace cdiff::node_graph
