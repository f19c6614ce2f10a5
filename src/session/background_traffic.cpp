// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/background_traffic.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::session {
namespace {

using simulation::SimulatedVehicle;
using traffic::Vehicle;

/// Where a vehicle that was just added will appear.
Vehicle placed(const map::RoadNetwork& network, const simulation::DemandVehicle& added) {
  const std::vector<map::LaneIndex> lanes = network.lanesOfEdge(added.edges.front());
  const auto& centerline =
      network.lane(lanes[static_cast<std::size_t>(added.depart_lane)]).centerline;
  const double center = added.depart_position - 0.5 * added.dimensions.length;
  const Eigen::Vector3d point = centerline.pointAt(center);
  Vehicle vehicle;
  vehicle.id = added.id;
  vehicle.dimensions = added.dimensions;
  vehicle.state = {point.head<2>(), point.z(), centerline.headingAt(center), added.depart_speed};
  return vehicle;
}

/// Whether a vehicle could not avoid an ego that suddenly stands at `start`: nearer than
/// `clearance`, or approaching from behind along the ego's heading faster than it can comfortably
/// brake.
bool inTheWay(const traffic::VehicleState& state, const traffic::VehicleState& start,
              double clearance) {
  constexpr double kComfortableBraking = 2.5;  // [m/s^2]
  constexpr double kLaneHalfWidth = 2.5;       // [m]
  const Eigen::Vector2d body = start.pose().toBody(state.position);
  if (body.norm() < clearance) return true;
  const double closing = std::max(0.0, state.speed - start.speed);
  const double needed = clearance + closing * closing / (2.0 * kComfortableBraking);
  const bool same_direction = std::abs(core::angleDifference(state.heading, start.heading)) < 0.5;
  return same_direction && body.x() < 0.0 && -body.x() < needed &&
         std::abs(body.y()) < kLaneHalfWidth;
}

}  // namespace

BackgroundTraffic::BackgroundTraffic(const SessionSetup& setup,
                                     simulation::TrafficSimulator& simulator)
    : setup_(setup), simulator_(simulator) {
  const ScenarioOptions& options = setup.options();
  if (options.demand != "generated") return;
  demand_ = std::make_unique<simulation::DemandGenerator>(
      options.traffic, setup.graph(), setup.egoRoute(), static_cast<std::uint64_t>(options.seed));
}

void BackgroundTraffic::warmUp() {
  const ScenarioOptions& options = setup_.options();
  if (options.demand == "none") return;
  const DrivenVehicles nobody(options.vehicle);
  const auto steps =
      static_cast<int>(std::lround(options.traffic.warm_up / options.simulation_step));
  const auto steps_per_second = static_cast<int>(std::lround(1.0 / options.simulation_step));
  for (int i = 0; i < steps; ++i) {
    if (i % steps_per_second == 0) refill(nullptr, nobody, true);
    simulator_.step({});
  }
}

void BackgroundTraffic::clearStart(const traffic::VehicleState& start) {
  const double clearance = setup_.options().traffic.clear_start;
  for (const SimulatedVehicle& vehicle : simulator_.vehicles()) {
    if (traffic::onDifferentLevels(vehicle.state.elevation, start.elevation)) continue;
    if (inTheWay(vehicle.state, start, clearance)) simulator_.remove(vehicle.id);
  }
}

void BackgroundTraffic::keepDensity(const Vehicle* ego, const DrivenVehicles& driven) {
  refill(ego, driven, false);
}

void BackgroundTraffic::refill(const Vehicle* ego, const DrivenVehicles& driven, bool warm_up) {
  if (!demand_) return;
  constexpr int kMostTries = 200;
  const Eigen::Vector3d start = setup_.egoRoute().path().pointAt(0.0);
  const Eigen::Vector2d center = ego ? ego->state.position : Eigen::Vector2d(start.head<2>());
  const double elevation = ego ? ego->state.elevation : start.z();
  std::vector<Vehicle> vehicles = present(center, driven);
  for (int i = 0; i < kMostTries; ++i) {
    const auto wanted = demand_->next(vehicles, center, elevation, warm_up);
    if (!wanted) return;
    const bool added =
        simulator_.addBackground(wanted->id, wanted->edges, wanted->depart_position,
                                 wanted->depart_lane, wanted->depart_speed, wanted->dimensions);
    if (added) vehicles.push_back(placed(setup_.network(), *wanted));
  }
}

/// All vehicles but those that are too far from `center`, which leave.
std::vector<Vehicle> BackgroundTraffic::present(const Eigen::Vector2d& center,
                                                const DrivenVehicles& driven) {
  std::vector<Vehicle> vehicles;
  for (const SimulatedVehicle& vehicle : simulator_.vehicles()) {
    const double distance = (vehicle.state.position - center).norm();
    if (distance <= setup_.options().traffic.forget_distance || driven.contain(vehicle.id))
      vehicles.push_back(simulation::asBackground(vehicle));
    else
      simulator_.remove(vehicle.id);
  }
  for (const Vehicle& ours : driven.snapshot(simulator_.vehicles())) {
    for (Vehicle& other : vehicles) {
      if (other.id == ours.id) other = ours;
    }
  }
  return vehicles;
}

}  // namespace cdiff::session
