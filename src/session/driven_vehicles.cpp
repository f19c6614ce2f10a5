// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/driven_vehicles.h"

#include <algorithm>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"

namespace cdiff::session {

using simulation::DrivenVehicle;
using traffic::Vehicle;

struct DrivenVehicles::Driven {
  std::string id;
  traffic::VehicleRole role = traffic::VehicleRole::kCbv;
  int slot = -1;
  traffic::VehicleState state;
  traffic::VehicleDimensions dimensions;
  double acceleration = 0.0;
  double yaw_rate = 0.0;
  std::optional<traffic::ControlAction> action;  ///< absent until the first decision
  map::Route route;
  double arc_length = 0.0;  ///< progress along the route [m]

  DrivenVehicle forSimulator() const { return {id, state, &route}; }
  void move(const dynamics::BicycleModel& dynamics, double step);
  Vehicle snapshot() const;
};

namespace {

std::string faultText(const planning::PlannedAction& planned) {
  const traffic::ControlAction& action = planned.action;
  return "vehicle '" + planned.vehicle_id + "' got throttle " +
         core::formatNumber(action.throttle) + ", steer " + core::formatNumber(action.steer) +
         ", brake " + core::formatNumber(action.brake) + "; full braking instead";
}

}  // namespace

void DrivenVehicles::Driven::move(const dynamics::BicycleModel& dynamics, double step) {
  constexpr geometry::SearchWindow kWindow{30.0, 30.0};
  if (!action) action = traffic::ControlAction::failSafe();
  const traffic::VehicleState before = state;
  state = dynamics.step(before, *action, step);
  acceleration = (state.speed - before.speed) / step;
  yaw_rate = core::angleDifference(state.heading, before.heading) / step;
  const auto near = route.path().projectNear(state.position, arc_length, kWindow);
  arc_length = near.arc_length;
  state.elevation = near.elevation;
}

Vehicle DrivenVehicles::Driven::snapshot() const {
  Vehicle vehicle;
  vehicle.id = id;
  vehicle.role = role;
  vehicle.cbv_slot = slot;
  vehicle.state = state;
  vehicle.dimensions = dimensions;
  vehicle.acceleration = acceleration;
  vehicle.yaw_rate = yaw_rate;
  vehicle.applied_action = action;
  return vehicle;
}

DrivenVehicles::DrivenVehicles(const dynamics::BicycleModelOptions& options) : dynamics_(options) {}

DrivenVehicles::~DrivenVehicles() = default;

DrivenVehicles::Iterator DrivenVehicles::position(const std::string& id) const {
  return std::find_if(vehicles_.begin(), vehicles_.end(),
                      [&](const std::unique_ptr<Driven>& vehicle) { return vehicle->id == id; });
}

bool DrivenVehicles::contain(const std::string& id) const {
  return position(id) != vehicles_.end();
}

std::optional<DrivenVehicle> DrivenVehicles::find(const std::string& id) const {
  const Iterator found = position(id);
  if (found == vehicles_.end()) return std::nullopt;
  return (*found)->forSimulator();
}

void DrivenVehicles::addEgo(const std::string& id, const map::Route& route,
                            const traffic::VehicleState& start) {
  auto ego = std::make_unique<Driven>();
  ego->id = id;
  ego->role = traffic::VehicleRole::kEgo;
  ego->route = route;
  ego->state = start;
  vehicles_.insert(vehicles_.begin(), std::move(ego));
}

void DrivenVehicles::addCbv(const cbv::CbvAssignment& assignment,
                            const simulation::SimulatedVehicle& simulated,
                            const traffic::VehicleState& start) {
  auto vehicle = std::make_unique<Driven>();
  vehicle->id = simulated.id;
  vehicle->slot = assignment.slot;
  vehicle->state = start;
  vehicle->dimensions = simulated.dimensions;
  vehicle->acceleration = simulated.acceleration;
  vehicle->route = assignment.conflict_aware_route;
  const auto after = std::upper_bound(
      vehicles_.begin(), vehicles_.end(), assignment.slot,
      [](int slot, const std::unique_ptr<Driven>& other) { return slot < other->slot; });
  vehicles_.insert(after, std::move(vehicle));
}

void DrivenVehicles::remove(const std::string& id) {
  const Iterator found = position(id);
  if (found != vehicles_.end()) vehicles_.erase(found);
}

std::vector<std::string> DrivenVehicles::command(
    const std::vector<planning::PlannedAction>& actions) {
  std::vector<std::string> faults;
  for (const planning::PlannedAction& planned : actions) {
    const Iterator found = position(planned.vehicle_id);
    if (found == vehicles_.end()) continue;
    const bool valid = planned.action.valid();
    (*found)->action = valid ? planned.action : traffic::ControlAction::failSafe();
    if (!valid) faults.push_back(faultText(planned));
  }
  return faults;
}

void DrivenVehicles::move(double step) {
  for (const std::unique_ptr<Driven>& vehicle : vehicles_) vehicle->move(dynamics_, step);
}

std::vector<DrivenVehicle> DrivenVehicles::moves() const {
  std::vector<DrivenVehicle> moves;
  for (const std::unique_ptr<Driven>& vehicle : vehicles_) moves.push_back(vehicle->forSimulator());
  return moves;
}

std::vector<Vehicle> DrivenVehicles::snapshot(
    const std::vector<simulation::SimulatedVehicle>& simulated) const {
  std::vector<Vehicle> vehicles;
  for (const std::unique_ptr<Driven>& driven : vehicles_) {
    vehicles.push_back(driven->snapshot());
    const simulation::SimulatedVehicle* echo = simulation::findVehicle(simulated, driven->id);
    if (echo != nullptr) vehicles.back().lane_id = echo->lane_id;
  }
  return vehicles;
}

namespace {

bool touch(const Vehicle& ours, const Vehicle& other) {
  const double reach = 0.5 * (ours.dimensions.length + ours.dimensions.width +
                              other.dimensions.length + other.dimensions.width);
  if ((ours.state.position - other.state.position).squaredNorm() > reach * reach) return false;
  return !traffic::onDifferentLevels(ours, other) && geometry::overlap(ours.box(), other.box());
}

}  // namespace

TickContacts findContacts(const std::vector<Vehicle>& vehicles, std::size_t driven) {
  TickContacts found;
  for (std::size_t i = 0; i < driven; ++i) {
    for (std::size_t j = i + 1; j < vehicles.size(); ++j) {
      if (!touch(vehicles[i], vehicles[j])) continue;
      const auto [first, second] = std::minmax(vehicles[i].id, vehicles[j].id);
      found.contacts.push_back({first, second});
      for (const Vehicle* vehicle : {&vehicles[i], &vehicles[j]}) {
        if (vehicle->role != traffic::VehicleRole::kEgo) found.leaving.push_back(vehicle->id);
      }
    }
  }
  return found;
}

}  // namespace cdiff::session
