// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/message_checks.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include "core/markup.h"
#include "core/text.h"

namespace cdiff::node_graph {

namespace msgs = ::e2e_cdiff;

namespace {

constexpr double kFarthest = 1e7;    // [m] from the network's origin
constexpr double kFastest = 1e3;     // [m/s]
constexpr double kLargestBox = 1e3;  // [m] of a vehicle's box

bool within(double value, double limit) { return std::isfinite(value) && std::abs(value) <= limit; }

bool plausible(const msgs::Vehicle& vehicle) {
  const msgs::VehicleState& state = vehicle.state;
  const auto size = [](double value) { return value > 0.0 && value <= kLargestBox; };
  return within(state.x, kFarthest) && within(state.y, kFarthest) && within(state.z, kFarthest) &&
         within(state.heading, kFarthest) && within(state.speed, kFastest) &&
         std::isfinite(vehicle.acceleration) && std::isfinite(vehicle.yaw_rate) &&
         size(vehicle.length) && size(vehicle.width) && size(vehicle.height);
}

/// What is wrong with a vehicle by itself; empty where nothing is.
std::string faultOf(const msgs::Vehicle& vehicle) {
  if (vehicle.role > msgs::Vehicle::BACKGROUND)
    return "has the unknown role " + std::to_string(vehicle.role);
  if (!plausible(vehicle)) return "has a state or size that no vehicle can have";
  if (core::plainText(vehicle.id) != vehicle.id) return "has an id that is no plain text";
  return "";
}

std::string named(std::string_view id) {
  return "vehicle '" + core::fileName(std::string(id)) + "' ";
}

/// Every node looks at all vehicles of every tick: nothing is put into words that is right.
std::string wrongVehicles(const std::vector<msgs::Vehicle>& vehicles) {
  std::vector<std::string_view> ids;
  ids.reserve(vehicles.size());
  for (const msgs::Vehicle& vehicle : vehicles) {
    if (const std::string fault = faultOf(vehicle); !fault.empty())
      return named(vehicle.id) + fault;
    ids.push_back(vehicle.id);
  }
  std::sort(ids.begin(), ids.end());
  const auto twice = std::adjacent_find(ids.begin(), ids.end());
  if (twice != ids.end()) return named(*twice) + "is there twice";
  const msgs::Vehicle* ego = nullptr;
  for (const msgs::Vehicle& vehicle : vehicles) {
    if (vehicle.role != msgs::Vehicle::EGO) continue;
    if (ego != nullptr) return "it has two egos, '" + ego->id + "' and '" + vehicle.id + "'";
    ego = &vehicle;
  }
  return "";
}

bool finite(const geometry_msgs::Point& point) {
  return within(point.x, kFarthest) && within(point.y, kFarthest) && within(point.z, kFarthest);
}

std::string wrongRoute(const msgs::CbvAssignment& assignment, const map::RoadNetwork& network) {
  const auto& points = assignment.route_points;
  if (points.empty()) return "";
  if (points.size() < 2 || points.size() != assignment.route_lane_ids.size())
    return "has " + std::to_string(points.size()) + " points and " +
           std::to_string(assignment.route_lane_ids.size()) + " lanes";
  if (!std::all_of(points.begin(), points.end(), finite)) return "has a point that is nowhere";
  for (const std::string& id : assignment.route_lane_ids) {
    if (network.findLane(id) == map::kNoLane)
      return "names lane '" + core::fileName(id) + "', which the network does not have";
  }
  return "";
}

}  // namespace

std::string unusable(const msgs::TrafficSnapshot& message, double simulation_step) {
  constexpr double kRounding = 1e-6;
  if (message.status > msgs::TrafficSnapshot::ERROR)
    return "it has the unknown status " + std::to_string(message.status);
  const double time = static_cast<double>(message.tick) * simulation_step;
  if (!(std::abs(message.time - time) <= kRounding * std::max(1.0, time))) {
    return "its time is " + core::formatNumber(message.time) + " s; the tick's is " +
           core::formatNumber(time) + " s";
  }
  return wrongVehicles(message.vehicles);
}

std::string unusable(const msgs::CbvSelection& message, const map::RoadNetwork& network) {
  for (const msgs::CbvAssignment& assignment : message.assignments) {
    const std::string wrong = wrongRoute(assignment, network);
    if (!wrong.empty())
      return "the route of CBV '" + core::fileName(assignment.vehicle_id) + "' " + wrong;
  }
  return "";
}

std::string wrongSlot(int slot) {
  return "it names slot " + std::to_string(slot) + ", which is not the topic's";
}

std::string unusable(const msgs::CbvSelection& message, int max_cbv) {
  const std::string slots = "; the session has " + std::to_string(max_cbv) + " slots";
  if (message.assignments.size() > static_cast<std::size_t>(max_cbv))
    return "it holds " + std::to_string(message.assignments.size()) + " assignments" + slots;
  std::set<int> taken;
  std::set<std::string_view> vehicles;
  for (const msgs::CbvAssignment& assignment : message.assignments) {
    const std::string name = "slot " + std::to_string(assignment.slot);
    if (assignment.slot < 0 || assignment.slot >= max_cbv) return "it names " + name + slots;
    if (!taken.insert(assignment.slot).second) return "it names " + name + " twice";
    if (!vehicles.insert(assignment.vehicle_id).second)
      return "it names vehicle '" + core::fileName(assignment.vehicle_id) + "' twice";
  }
  return "";
}

}  // namespace cdiff::node_graph
