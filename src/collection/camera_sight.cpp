// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/camera_sight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "planners/pdm_lite/route_rules.h"

namespace cdiff::collection {
namespace {

constexpr int kRows = 10;
constexpr int kColumns = 3;            // to each side
constexpr double kRowLength = 4.0;     // [m]
constexpr double kColumnWidth = 3.5;   // [m]
constexpr double kLeaderScale = 20.0;  // [m]
constexpr double kLeaderReach = 60.0;  // [m]
constexpr double kSpeedScale = 10.0;   // [m/s]
constexpr std::size_t kLeaderTargets = 2;

/// Of the cell in which a place ahead lies, among the targets; nullopt outside the grid.
std::optional<std::size_t> cellOf(const Eigen::Vector2d& place) {
  const int row = static_cast<int>(std::floor(place.x() / kRowLength));
  const int column = static_cast<int>(std::floor(std::abs(place.y()) / kColumnWidth));
  if (row < 0 || row >= kRows || column >= kColumns) return std::nullopt;
  const int side = place.y() > 0.0 ? 0 : 1;
  return kLeaderTargets + static_cast<std::size_t>((side * kRows + row) * kColumns + column);
}

}  // namespace

CameraSight::CameraSight(const rendering::CameraOptions& camera, const map::RoadNetwork& network)
    : renderer_(rendering::frontRig(camera), network) {}

std::vector<bool> CameraSight::seenBy(const traffic::Vehicle& vehicle,
                                      const traffic::TrafficSnapshot& snapshot) {
  const std::vector<int> pixels = rendering::mostPixels(
      renderer_.render(snapshot, vehicle, rendering::Labels::kClassesAndInstances),
      snapshot.vehicles.size());
  std::vector<bool> seen;
  seen.reserve(pixels.size());
  for (const int count : pixels) seen.push_back(count >= kSeenPixels);
  return seen;
}

traffic::TrafficSnapshot SightedPlanner::known(const traffic::TrafficSnapshot& snapshot,
                                               const traffic::Vehicle& vehicle, Driver& driver) {
  const std::vector<bool> seen = sight_.seenBy(vehicle, snapshot);
  traffic::TrafficSnapshot known = snapshot;
  known.vehicles.clear();
  std::map<std::string, double> last;
  for (std::size_t i = 0; i < snapshot.vehicles.size(); ++i) {
    const traffic::Vehicle& other = snapshot.vehicles[i];
    const auto before = driver.seen.find(other.id);
    const double when = seen[i]                       ? snapshot.time
                        : before == driver.seen.end() ? -std::numeric_limits<double>::infinity()
                                                      : before->second;
    const bool remembered = snapshot.time - when <= kMemory;
    if (remembered) last.emplace(other.id, when);
    if (remembered || other.id == vehicle.id) known.vehicles.push_back(other);
  }
  driver.seen = std::move(last);
  return known;
}

std::vector<planning::PlannedAction> SightedPlanner::plan(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks) {
  std::vector<planning::PlannedAction> actions;
  std::map<std::string, Driver> drivers;
  for (const planning::PlanningTask& task : tasks) {
    Driver& driver = drivers[task.vehicle->id];
    const auto before = drivers_.find(task.vehicle->id);
    if (before != drivers_.end()) driver = std::move(before->second);
    if (!driver.planner) driver.planner = make_();
    for (planning::PlannedAction& action :
         driver.planner->plan(known(snapshot, *task.vehicle, driver), {task}))
      actions.push_back(std::move(action));
  }
  drivers_ = std::move(drivers);
  return actions;
}

std::vector<std::string> sightTargets() {
  std::vector<std::string> names = {"leader_near", "leader_relative_speed"};
  for (const char* side : {"left", "right"}) {
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column)
        names.push_back(std::string("occupied_") + side + "_" + std::to_string(row) + "_" +
                        std::to_string(column));
    }
  }
  return names;
}

std::vector<float> sightTargetsOf(const traffic::Vehicle& vehicle,
                                  const traffic::TrafficSnapshot& snapshot,
                                  const std::vector<bool>& seen, const map::Route& route,
                                  double arc_length) {
  std::vector<float> targets(kLeaderTargets + 2 * kRows * kColumns, 0.0F);
  targets[1] = std::numeric_limits<float>::quiet_NaN();
  double nearest = kLeaderReach;
  for (std::size_t i = 0; i < snapshot.vehicles.size(); ++i) {
    if (!seen[i]) continue;
    const traffic::Vehicle& other = snapshot.vehicles[i];
    const Eigen::Vector2d place = vehicle.state.pose().toBody(other.state.position);
    if (const auto cell = cellOf(place)) targets[*cell] = 1.0F;
    const double distance = place.norm();
    if (distance >= nearest || !planners::isLeading(route, arc_length, other.state)) continue;
    nearest = distance;
    targets[0] = static_cast<float>(std::exp(-distance / kLeaderScale));
    targets[1] = static_cast<float>((other.state.speed - vehicle.state.speed) / kSpeedScale);
  }
  return targets;
}

}  // namespace cdiff::collection
