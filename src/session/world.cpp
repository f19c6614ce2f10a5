// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/world.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::session {

using simulation::DrivenVehicle;
using simulation::SimulatedVehicle;
using traffic::SessionStatus;
using traffic::Vehicle;
using traffic::VehicleRole;

/// A vehicle that our dynamics moves.
struct World::Driven {
  std::string id;
  VehicleRole role = VehicleRole::kCbv;
  int slot = -1;
  traffic::VehicleState state;
  traffic::VehicleDimensions dimensions;
  double acceleration = 0.0;
  double yaw_rate = 0.0;
  std::optional<traffic::ControlAction> action;  ///< held; absent until the first decision
  map::Route route;
  double arc_length = 0.0;  ///< progress along the route [m]

  DrivenVehicle forSimulator() const { return {id, state, &route}; }
};

namespace {

simulation::SumoSession sumoSession(const SessionSetup& setup) {
  const ScenarioOptions& options = setup.options();
  simulation::SumoSession session;
  session.network_file = setup.import().file;
  session.network_source = setup.import().source;
  if (options.demand != "generated" && options.demand != "none")
    session.demand_file = options.demand;
  session.begin_time = options.begin_time;
  session.simulation_step = options.simulation_step;
  session.seed = static_cast<std::uint64_t>(options.seed);
  session.lights_green = options.lights == "green";
  return session;
}

Vehicle background(const SimulatedVehicle& simulated) {
  Vehicle vehicle;
  vehicle.id = simulated.id;
  vehicle.state = simulated.state;
  vehicle.dimensions = simulated.dimensions;
  vehicle.acceleration = simulated.acceleration;
  vehicle.lane_id = simulated.lane_id;
  return vehicle;
}

const SimulatedVehicle* findSimulated(const std::vector<SimulatedVehicle>& vehicles,
                                      const std::string& id) {
  const auto found = std::lower_bound(
      vehicles.begin(), vehicles.end(), id,
      [](const SimulatedVehicle& vehicle, const std::string& key) { return vehicle.id < key; });
  return found != vehicles.end() && found->id == id ? &*found : nullptr;
}

/// Where a vehicle that was just added will appear.
traffic::VehicleState placedState(const map::RoadNetwork& network,
                                  const simulation::DemandVehicle& added) {
  const std::vector<map::LaneIndex> lanes = network.lanesOfEdge(added.edges.front());
  const auto& centerline =
      network.lane(lanes[static_cast<std::size_t>(added.depart_lane)]).centerline;
  const double center = added.depart_position - 0.5 * added.dimensions.length;
  const Eigen::Vector3d point = centerline.pointAt(center);
  return {point.head<2>(), point.z(), centerline.headingAt(center), added.depart_speed};
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

World::World(const SessionSetup& setup)
    : setup_(setup),
      dynamics_(setup.options().vehicle),
      monitor_(setup.options().protocol, setup.egoRoute()) {
  const ScenarioOptions& options = setup.options();
  simulator_ = std::make_unique<simulation::SumoSimulator>(options.sumo, sumoSession(setup),
                                                           setup.network());
  if (options.demand == "generated") {
    demand_ = std::make_unique<simulation::DemandGenerator>(
        options.traffic, setup.graph(), setup.egoRoute(), static_cast<std::uint64_t>(options.seed));
  }
  warmUp();
  placeEgo();
  takeSnapshot();
}

World::~World() = default;

std::string World::simulatorVersion() const { return simulator_->version(); }

int World::simulatorProcessId() const { return simulator_->processId(); }

void World::warmUp() {
  const ScenarioOptions& options = setup_.options();
  if (options.demand == "none") return;
  const auto steps =
      static_cast<int>(std::lround(options.traffic.warm_up / options.simulation_step));
  const auto steps_per_second = static_cast<int>(std::lround(1.0 / options.simulation_step));
  for (int i = 0; i < steps; ++i) {
    if (i % steps_per_second == 0) keepDensity(true);
    simulator_->step({});
  }
}

bool World::isOurs(const std::string& id) const {
  return std::any_of(driven_.begin(), driven_.end(),
                     [&](const std::unique_ptr<Driven>& vehicle) { return vehicle->id == id; });
}

/// Vehicles that SUMO drives and that are not too far from the ego; those that are leave.
std::vector<Vehicle> World::presentTraffic(const Eigen::Vector2d& ego_position) {
  std::vector<Vehicle> present;
  for (const SimulatedVehicle& vehicle : simulator_->vehicles()) {
    const double distance = (vehicle.state.position - ego_position).norm();
    if (distance <= setup_.options().traffic.forget_distance || isOurs(vehicle.id))
      present.push_back(background(vehicle));
    else
      simulator_->remove(vehicle.id);
  }
  for (const std::unique_ptr<Driven>& vehicle : driven_) {
    for (Vehicle& other : present) {
      if (other.id == vehicle->id) other = snapshotOf(*vehicle);
    }
  }
  return present;
}

void World::keepDensity(bool warm_up) {
  if (!demand_) return;
  constexpr int kMostTries = 200;
  const Eigen::Vector3d start = setup_.egoRoute().path().pointAt(0.0);
  const Vehicle* ego = snapshot_.ego();
  const Eigen::Vector2d center = ego ? ego->state.position : Eigen::Vector2d(start.head<2>());
  const double elevation = ego ? ego->state.elevation : start.z();
  std::vector<Vehicle> present = presentTraffic(center);
  for (int i = 0; i < kMostTries; ++i) {
    const auto wanted = demand_->next(present, center, elevation, warm_up);
    if (!wanted) return;
    const bool added =
        simulator_->addBackground(wanted->id, wanted->edges, wanted->depart_position,
                                  wanted->depart_lane, wanted->depart_speed, wanted->dimensions);
    if (!added) continue;
    Vehicle placed;
    placed.id = wanted->id;
    placed.dimensions = wanted->dimensions;
    placed.state = placedState(setup_.network(), *wanted);
    present.push_back(placed);
  }
}

void World::placeEgo() {
  auto ego = std::make_unique<Driven>();
  ego->id = kEgoId;
  ego->role = VehicleRole::kEgo;
  ego->route = setup_.egoRoute();
  const Eigen::Vector3d start = ego->route.path().pointAt(0.0);
  ego->state = {start.head<2>(), start.z(), ego->route.path().headingAt(0.0),
                setup_.options().route.start_speed};
  for (const SimulatedVehicle& vehicle : simulator_->vehicles()) {
    const bool same_level = std::abs(vehicle.state.elevation - ego->state.elevation) < 2.5;
    if (same_level && inTheWay(vehicle.state, ego->state, setup_.options().traffic.clear_start)) {
      simulator_->remove(vehicle.id);
    }
  }
  simulator_->addDriven(ego->id, ego->dimensions, ego->forSimulator());
  driven_.push_back(std::move(ego));
  stepSimulator();
}

void World::recordFault(const std::string& source, const std::string& text) {
  pending_faults_.push_back({snapshot_.tick, source, text});
}

void World::end(SessionStatus status, const traffic::Fault& fault) {
  if (snapshot_.status != SessionStatus::kRunning) return;
  snapshot_.tick += 1;
  snapshot_.time = static_cast<double>(snapshot_.tick) * setup_.options().simulation_step;
  snapshot_.decision_tick = false;
  snapshot_.contacts.clear();
  snapshot_.removed.clear();
  snapshot_.status = status;
  snapshot_.faults = std::move(pending_faults_);
  snapshot_.faults.push_back(fault);
  pending_faults_.clear();
}

void World::advance(const cbv::CbvSelection* selection,
                    const std::vector<planning::PlannedAction>& actions) {
  if (snapshot_.status != SessionStatus::kRunning)
    throw std::logic_error("the session has already ended");
  try {
    const std::vector<std::string> removed = std::move(to_remove_);
    to_remove_.clear();
    removeContacted(removed);
    if (selection != nullptr) applySelection(*selection, removed);
    applyActions(actions);
    moveDriven();
    const auto ticks_per_second =
        static_cast<std::uint64_t>(std::llround(1.0 / setup_.options().simulation_step));
    if (snapshot_.tick % ticks_per_second == 0) keepDensity(false);
    stepSimulator();
    takeSnapshot();
  } catch (const core::InputError& error) {
    end(SessionStatus::kError, {snapshot_.tick, traffic::kInputFault, error.what()});
  } catch (const core::Error& error) {
    end(SessionStatus::kError, {snapshot_.tick, "simulator", error.what()});
  }
}

void World::removeContacted(const std::vector<std::string>& removed) {
  for (const std::string& id : removed) {
    const auto is_it = [&](const std::unique_ptr<Driven>& vehicle) { return vehicle->id == id; };
    driven_.erase(std::remove_if(driven_.begin(), driven_.end(), is_it), driven_.end());
    if (findSimulated(simulator_->vehicles(), id) != nullptr) simulator_->remove(id);
  }
}

void World::applySelection(const cbv::CbvSelection& selection,
                           const std::vector<std::string>& removed) {
  for (const cbv::ReleasedCbv& released : selection.released) release(released.vehicle_id);
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    if (isOurs(assignment.vehicle_id)) continue;
    if (std::find(removed.begin(), removed.end(), assignment.vehicle_id) != removed.end()) continue;
    takeOver(assignment);
  }
  const auto by_slot = [](const std::unique_ptr<Driven>& left,
                          const std::unique_ptr<Driven>& right) {
    return left->slot < right->slot;
  };
  std::sort(driven_.begin(), driven_.end(), by_slot);
}

void World::takeOver(const cbv::CbvAssignment& assignment) {
  const SimulatedVehicle* simulated = findSimulated(simulator_->vehicles(), assignment.vehicle_id);
  if (simulated == nullptr) return;
  auto vehicle = std::make_unique<Driven>();
  vehicle->id = assignment.vehicle_id;
  vehicle->slot = assignment.slot;
  vehicle->state = simulated->state;
  if (disturbance_) vehicle->state = disturbance_(vehicle->id, vehicle->state);
  vehicle->dimensions = simulated->dimensions;
  vehicle->acceleration = simulated->acceleration;
  vehicle->route = assignment.conflict_aware_route;
  simulator_->takeOver(vehicle->id);
  driven_.push_back(std::move(vehicle));
}

void World::release(const std::string& id) {
  const auto is_it = [&](const std::unique_ptr<Driven>& vehicle) { return vehicle->id == id; };
  const auto found = std::find_if(driven_.begin(), driven_.end(), is_it);
  if (found == driven_.end()) return;
  simulator_->release((*found)->forSimulator());
  driven_.erase(found);
}

void World::applyActions(const std::vector<planning::PlannedAction>& actions) {
  for (const planning::PlannedAction& planned : actions) {
    for (const std::unique_ptr<Driven>& vehicle : driven_) {
      if (vehicle->id != planned.vehicle_id) continue;
      vehicle->action = planned.action;
      if (planned.action.valid()) continue;
      vehicle->action = traffic::ControlAction::failSafe();
      recordFault("command", "vehicle '" + vehicle->id + "' got throttle " +
                                 core::formatNumber(planned.action.throttle) + ", steer " +
                                 core::formatNumber(planned.action.steer) + ", brake " +
                                 core::formatNumber(planned.action.brake) +
                                 "; full braking instead");
    }
  }
}

void World::moveDriven() {
  constexpr double kWindow = 30.0;  // [m] of route around the last place
  const double step = setup_.options().simulation_step;
  for (const std::unique_ptr<Driven>& vehicle : driven_) {
    if (!vehicle->action) vehicle->action = traffic::ControlAction::failSafe();
    const traffic::VehicleState before = vehicle->state;
    vehicle->state = dynamics_.step(before, *vehicle->action, step);
    vehicle->acceleration = (vehicle->state.speed - before.speed) / step;
    vehicle->yaw_rate = core::angleDifference(vehicle->state.heading, before.heading) / step;
    const auto near = vehicle->route.path().project(
        vehicle->state.position, std::max(0.0, vehicle->arc_length - kWindow),
        std::min(vehicle->route.length(), vehicle->arc_length + kWindow));
    vehicle->arc_length = near.arc_length;
    vehicle->state.elevation = near.elevation;
  }
}

void World::stepSimulator() {
  std::vector<DrivenVehicle> moves;
  for (const std::unique_ptr<Driven>& vehicle : driven_) moves.push_back(vehicle->forSimulator());
  simulator_->step(moves);
}

Vehicle World::snapshotOf(const Driven& driven) const {
  Vehicle vehicle;
  vehicle.id = driven.id;
  vehicle.role = driven.role;
  vehicle.cbv_slot = driven.slot;
  vehicle.state = driven.state;
  vehicle.dimensions = driven.dimensions;
  vehicle.acceleration = driven.acceleration;
  vehicle.yaw_rate = driven.yaw_rate;
  vehicle.applied_action = driven.action;
  const SimulatedVehicle* simulated = findSimulated(simulator_->vehicles(), driven.id);
  if (simulated != nullptr) vehicle.lane_id = simulated->lane_id;
  return vehicle;
}

void World::collectVehicles(const std::vector<Vehicle>& before) {
  std::unordered_map<std::string, double> headings;
  for (const Vehicle& vehicle : before) headings.emplace(vehicle.id, vehicle.state.heading);
  for (const std::unique_ptr<Driven>& vehicle : driven_)
    snapshot_.vehicles.push_back(snapshotOf(*vehicle));
  for (const SimulatedVehicle& simulated : simulator_->vehicles()) {
    if (isOurs(simulated.id)) continue;
    Vehicle vehicle = background(simulated);
    const auto heading = headings.find(vehicle.id);
    if (heading != headings.end()) {
      vehicle.yaw_rate = core::angleDifference(vehicle.state.heading, heading->second) /
                         setup_.options().simulation_step;
    }
    snapshot_.vehicles.push_back(std::move(vehicle));
  }
  std::unordered_set<std::string> present;
  for (const Vehicle& vehicle : snapshot_.vehicles) present.insert(vehicle.id);
  for (const Vehicle& vehicle : before) {
    if (present.count(vehicle.id) == 0) snapshot_.removed.push_back(vehicle.id);
  }
}

void World::takeSnapshot() {
  const std::vector<Vehicle> before = std::move(snapshot_.vehicles);
  snapshot_.vehicles.clear();
  snapshot_.removed.clear();
  snapshot_.contacts.clear();
  snapshot_.tick += before.empty() ? 0 : 1;
  snapshot_.time = static_cast<double>(snapshot_.tick) * setup_.options().simulation_step;
  collectVehicles(before);
  snapshot_.signals = simulator_->signals();
  findContacts();
  snapshot_.status = monitor_.update(snapshot_);
  const bool running = snapshot_.status == SessionStatus::kRunning;
  snapshot_.decision_tick = running && snapshot_.tick % setup_.ticksPerDecision() == 0;
  snapshot_.faults = std::move(pending_faults_);
  pending_faults_.clear();
}

void World::findContacts() {
  for (std::size_t i = 0; i < driven_.size(); ++i) {
    for (std::size_t j = i + 1; j < snapshot_.vehicles.size(); ++j) {
      checkContact(snapshot_.vehicles[i], snapshot_.vehicles[j]);
    }
  }
}

void World::checkContact(const Vehicle& ours, const Vehicle& other) {
  const double reach = 0.5 * (ours.dimensions.length + ours.dimensions.width +
                              other.dimensions.length + other.dimensions.width);
  if ((ours.state.position - other.state.position).squaredNorm() > reach * reach) return;
  if (traffic::onDifferentLevels(ours, other) || !geometry::overlap(ours.box(), other.box()))
    return;
  const std::pair<std::string, std::string> pair = std::minmax(ours.id, other.id);
  snapshot_.contacts.push_back({pair.first, pair.second});
  for (const Vehicle* vehicle : {&ours, &other}) {
    if (vehicle->role != VehicleRole::kEgo) to_remove_.push_back(vehicle->id);
  }
}

}  // namespace cdiff::session
