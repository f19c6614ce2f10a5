// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/carla/carla_world.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/carla/carla_conversions.h"
#include "node_graph/lockstep/tick_record.h"
#include "session/driven_vehicles.h"

namespace cdiff::node_graph {
namespace {

using traffic::SessionStatus;
using traffic::Vehicle;
using traffic::VehicleRole;

/// In a snapshot's order: the ego, CBVs by slot, others by id.
bool comesBefore(const Vehicle& left, const Vehicle& right) {
  const auto rank = [](const Vehicle& vehicle) {
    return std::make_tuple(static_cast<int>(vehicle.role), vehicle.cbv_slot, vehicle.id);
  };
  static_assert(VehicleRole::kEgo < VehicleRole::kCbv);
  static_assert(VehicleRole::kCbv < VehicleRole::kBackground);
  return rank(left) < rank(right);
}

const Vehicle* withId(const std::vector<Vehicle>& vehicles, const std::string& id) {
  const auto found = std::find_if(vehicles.begin(), vehicles.end(),
                                  [&](const Vehicle& vehicle) { return vehicle.id == id; });
  return found == vehicles.end() ? nullptr : &*found;
}

}  // namespace

CarlaWorld::CarlaWorld(const session::SessionSetup& setup, const CarlaLink& link)
    : setup_(setup), link_(link), monitor_(setup.options().protocol, setup.egoRoute()) {}

void CarlaWorld::recordFault(const std::string& source, const std::string& text) {
  pending_faults_.push_back({snapshot_.tick, source, text});
}

/// The tick of a stamp; those that were left out are lost.
void CarlaWorld::advanceTo(const ros::Time& stamp) {
  const double step = setup_.options().simulation_step;
  if (!first_) {
    first_ = stamp;
    return;
  }
  constexpr double kTolerance = 0.1;  // of a step
  const double steps = (stamp - *first_).toSec() / step;
  const auto tick = static_cast<std::uint64_t>(std::llround(std::max(0.0, steps)));
  if (tick <= snapshot_.tick || std::abs(steps - std::round(steps)) > kTolerance) {
    throw core::SimulatorError("CARLA's ROS bridge: a frame " + core::formatNumber(steps * step) +
                               " s after the first, after one of " +
                               core::formatNumber(snapshot_.time) + " s; expected steps of " +
                               core::formatNumber(step) + " s");
  }
  const std::uint64_t lost = tick - snapshot_.tick - 1;
  if (lost > 0)
    recordFault(kCarlaBridge, std::to_string(lost) + " frames before tick " + std::to_string(tick) +
                                  " did not come");
  lost_ += lost;
  snapshot_.tick = tick;
}

void CarlaWorld::addMotion(Vehicle& vehicle, double seconds) const {
  const Vehicle* earlier = withId(before_, vehicle.id);
  if (earlier == nullptr || seconds <= 0.0) return;
  vehicle.acceleration = (vehicle.state.speed - earlier->state.speed) / seconds;
  vehicle.yaw_rate = core::angleDifference(vehicle.state.heading, earlier->state.heading) / seconds;
}

void CarlaWorld::collectVehicles(const CarlaFrame& frame) {
  const auto ticks = static_cast<double>(snapshot_.tick - before_tick_);
  const double seconds = ticks * setup_.options().simulation_step;
  for (const derived_object_msgs::Object& object : frame.objects->objects) {
    std::optional<Vehicle> vehicle = carlaVehicle(object, setup_.network().netOffset());
    if (!vehicle) continue;
    const std::string role = link_.roleOf(object.id);
    vehicle->id = link_.roles().idOf(object.id, role);
    const auto slot = slots_.find(vehicle->id);
    if (vehicle->id == traffic::kEgoId) vehicle->role = VehicleRole::kEgo;
    if (slot != slots_.end()) {
      vehicle->role = VehicleRole::kCbv;
      vehicle->cbv_slot = slot->second;
    }
    const auto state = frame.states.find(role);
    if (vehicle->role != VehicleRole::kBackground && state != frame.states.end())
      vehicle->applied_action = carlaAction(state->second->control);
    addMotion(*vehicle, seconds);
    snapshot_.vehicles.push_back(std::move(*vehicle));
  }
  std::sort(snapshot_.vehicles.begin(), snapshot_.vehicles.end(), comesBefore);
  for (const Vehicle& vehicle : before_) {
    if (snapshot_.find(vehicle.id) == nullptr) snapshot_.removed.push_back(vehicle.id);
  }
}

/// A pair counts again only after it has been apart for a while.
std::vector<traffic::Contact> CarlaWorld::newContacts() {
  constexpr double kApart = 5.0;  // [s]
  std::vector<traffic::Contact> begun;
  const std::size_t ours = slots_.size() + 1;
  const std::size_t driven = std::min(ours, snapshot_.vehicles.size());
  for (const traffic::Contact& contact :
       session::findContacts(snapshot_.vehicles, driven).contacts) {
    const auto [entry, first] =
        touched_.emplace(std::pair(contact.first, contact.second), snapshot_.time);
    if (first || snapshot_.time - entry->second > kApart) begun.push_back(contact);
    entry->second = snapshot_.time;
  }
  return begun;
}

void CarlaWorld::take(const CarlaFrame& frame, bool superseded) {
  before_tick_ = snapshot_.tick;
  before_ = std::exchange(snapshot_.vehicles, {});
  snapshot_.removed.clear();
  advanceTo(frame.stamp);
  snapshot_.time = static_cast<double>(snapshot_.tick) * setup_.options().simulation_step;
  collectVehicles(frame);
  snapshot_.contacts = newContacts();
  if (snapshot_.ego() == nullptr) recordFault(kCarlaBridge, "the ego is not among the objects");
  snapshot_.status = monitor_.update(snapshot_);
  const bool running = snapshot_.status == SessionStatus::kRunning;
  snapshot_.decision_tick = running && !superseded && snapshot_.tick >= next_decision_;
  if (snapshot_.decision_tick) {
    const std::uint64_t period = setup_.ticksPerDecision();
    next_decision_ = (snapshot_.tick / period + 1) * period;
  }
  snapshot_.faults = std::exchange(pending_faults_, {});
}

void CarlaWorld::assign(const cbv::CbvSelection& selection) {
  slots_.clear();
  for (const cbv::CbvAssignment& assignment : selection.assignments)
    slots_[assignment.vehicle_id] = assignment.slot;
}

void CarlaWorld::end(SessionStatus status, const std::string& source, const std::string& text) {
  recordFault(source, text);
  traffic::TrafficSnapshot last =
      endedAfter(snapshot_, setup_.options().simulation_step, status, {});
  last.faults = std::exchange(pending_faults_, {});
  snapshot_ = std::move(last);
}

}  // namespace cdiff::node_graph
