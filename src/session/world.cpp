// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/world.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "core/stage_times.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/driven_vehicles.h"
#include "traffic/shown_fault.h"

namespace cdiff::session {
namespace {

using simulation::SimulatedVehicle;
using traffic::Vehicle;

constexpr const char* kSteeringFault = "steering";

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
  const core::TimedStage stage("demand");
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

/// All vehicles but generated ones that are too far from `center`, which leave.
std::vector<Vehicle> BackgroundTraffic::present(const Eigen::Vector2d& center,
                                                const DrivenVehicles& driven) {
  std::vector<Vehicle> vehicles;
  for (const SimulatedVehicle& vehicle : simulator_.vehicles()) {
    const double distance = (vehicle.state.position - center).norm();
    if (distance <= setup_.options().traffic.forget_distance || driven.contain(vehicle.id) ||
        vehicle.id.rfind(simulation::kGeneratedPrefix, 0) != 0)
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

using traffic::SessionStatus;

World::World(const SessionSetup& setup) : World(setup, setup.makeSimulator()) {}

World::World(const SessionSetup& setup, std::unique_ptr<simulation::TrafficSimulator> simulator)
    : setup_(setup),
      control_(setup),
      simulator_(std::move(simulator)),
      background_(setup, *simulator_),
      driven_(setup.options().vehicle),
      monitor_(setup.options().protocol, setup.egoRoute()) {
  for (const std::string& text : setup.ignoredElements()) recordFault("storyboard", text);
  background_.warmUp();
  placeEgo();
  takeSnapshot();
  showSteering(changesAt(0));
}

void World::placeEgo() {
  const map::Route& route = setup_.egoRoute();
  const Eigen::Vector3d start = route.path().pointAt(0.0);
  const traffic::VehicleState state{start.head<2>(), start.z(), route.path().headingAt(0.0),
                                    setup_.options().route.start_speed};
  background_.clearStart(state);
  driven_.addEgo(traffic::kEgoId, route, state);
  simulator_->addDriven(traffic::kEgoId, traffic::VehicleDimensions(),
                        driven_.find(traffic::kEgoId).value());
  stepSimulator();
}

void World::recordFault(const std::string& source, const std::string& text) {
  pending_faults_.push_back(traffic::shownFault({snapshot_.tick, source, text}));
}

void World::end(SessionStatus status, const traffic::Fault& fault) {
  if (snapshot_.status != SessionStatus::kRunning) {
    if (status != SessionStatus::kError) return;
    snapshot_.status = status;
    snapshot_.faults.push_back(traffic::shownFault(fault));
    return;
  }
  snapshot_.tick += 1;
  snapshot_.time = static_cast<double>(snapshot_.tick) * setup_.options().simulation_step;
  snapshot_.decision_tick = false;
  snapshot_.contacts.clear();
  snapshot_.removed.clear();
  snapshot_.steering.clear();
  snapshot_.status = status;
  snapshot_.faults = std::move(pending_faults_);
  snapshot_.faults.push_back(traffic::shownFault(fault));
  pending_faults_.clear();
  control_.end();
}

void World::advance(const cbv::CbvSelection* selection,
                    const std::vector<planning::PlannedAction>& actions) {
  if (snapshot_.status != SessionStatus::kRunning)
    throw std::logic_error("the session has already ended");
  const core::TimedStage stage("world");
  try {
    const std::vector<std::string> removed = std::move(leaving_);
    leaving_.clear();
    removeContacted(removed);
    if (selection != nullptr) applySelection(*selection, removed);
    for (const std::string& fault : driven_.command(actions)) recordFault("command", fault);
    const double step = setup_.options().simulation_step;
    driven_.move(step);
    const auto ticks_per_second = static_cast<std::uint64_t>(std::llround(1.0 / step));
    if (snapshot_.tick % ticks_per_second == 0) background_.keepDensity(snapshot_.ego(), driven_);
    const std::vector<traffic::SteeringChange> steering = steer(snapshot_.tick + 1);
    stepSimulator();
    takeSnapshot();
    showSteering(steering);
  } catch (const core::InputError& error) {
    end(SessionStatus::kError, {snapshot_.tick, traffic::kInputFault, error.what()});
  } catch (const core::Error& error) {
    end(SessionStatus::kError, {snapshot_.tick, "simulator", error.what()});
  }
}

VehicleRoles World::roles() const {
  VehicleRoles roles;
  for (const Vehicle& vehicle : snapshot_.vehicles) roles.emplace(vehicle.id, vehicle.role);
  return roles;
}

/// What changes at a tick, given the vehicles of the snapshot that stands.
std::vector<traffic::SteeringChange> World::changesAt(std::uint64_t tick) {
  if (tick % setup_.ticksPerDecision() != 0) return {};
  std::vector<std::string> refused;
  const double time = static_cast<double>(tick) * setup_.options().simulation_step;
  std::vector<traffic::SteeringChange> changes = control_.take(time, roles(), refused);
  for (const std::string& text : refused) recordFault(kSteeringFault, text);
  return changes;
}

/// Puts what changes at the coming tick into the traffic before it; returns all that changes.
std::vector<traffic::SteeringChange> World::steer(std::uint64_t tick) {
  std::vector<traffic::SteeringChange> changes = changesAt(tick);
  for (const traffic::SteeringChange& change : changes) {
    if (change.what == steered::kPlace) placeVehicle(placedVehicle(change.after));
    if (change.what == steered::kRemove) removeContacted({change.before});
  }
  return changes;
}

/// Drives on along the lane and straight on beyond it.
void World::placeVehicle(const PlacedVehicle& vehicle) {
  constexpr double kRouteLength = 1000.0;  // [m]
  const map::RoadNetwork& network = setup_.network();
  const map::LaneIndex index = network.findLane(vehicle.lane);
  const map::Lane& lane = network.lane(index);
  const double length = lane.centerline.length();
  const map::Route route = setup_.graph().extended(
      setup_.graph().toRoute({{index}, length - vehicle.position}, vehicle.position, length),
      kRouteLength);
  std::vector<std::string> edges;
  for (const map::LaneIndex on_route : route.lanes()) {
    const map::Lane& next = network.lane(on_route);
    if (next.internal || (!edges.empty() && edges.back() == next.edge_id)) continue;
    edges.push_back(next.edge_id);
  }
  const traffic::VehicleDimensions dimensions;
  simulator_->addBackground(vehicle.id, edges, vehicle.position + 0.5 * dimensions.length,
                            lane.index, vehicle.speed, dimensions);
}

/// In the snapshot that was just taken; a vehicle that found no room was not placed.
void World::showSteering(const std::vector<traffic::SteeringChange>& changes) {
  for (const traffic::SteeringChange& change : changes) {
    const std::string id = change.what == steered::kPlace ? placedVehicle(change.after).id : "";
    if (id.empty() || snapshot_.find(id) != nullptr) {
      snapshot_.steering.push_back(change);
    } else {
      recordFault(kSteeringFault, "vehicle '" + id + "' found no room where the " + change.by +
                                      " places it; nothing was changed");
    }
  }
  if (snapshot_.decision_tick) control_.note(roles());
}

void World::removeContacted(const std::vector<std::string>& removed) {
  for (const std::string& id : removed) {
    driven_.remove(id);
    if (simulation::findVehicle(simulator_->vehicles(), id) != nullptr) simulator_->remove(id);
  }
}

void World::applySelection(const cbv::CbvSelection& selection,
                           const std::vector<std::string>& removed) {
  for (const cbv::ReleasedCbv& released : selection.released) release(released.vehicle_id);
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    const bool gone =
        std::find(removed.begin(), removed.end(), assignment.vehicle_id) != removed.end();
    if (!gone && !driven_.contain(assignment.vehicle_id)) takeOver(assignment);
  }
}

void World::takeOver(const cbv::CbvAssignment& assignment) {
  const SimulatedVehicle* simulated =
      simulation::findVehicle(simulator_->vehicles(), assignment.vehicle_id);
  if (simulated == nullptr) return;
  const traffic::VehicleState start =
      disturbance_ ? disturbance_(simulated->id, simulated->state) : simulated->state;
  driven_.addCbv(assignment, *simulated, start);
  simulator_->takeOver(assignment.vehicle_id);
}

void World::release(const std::string& id) {
  const auto vehicle = driven_.find(id);
  if (!vehicle) return;
  simulator_->release(*vehicle);
  driven_.remove(id);
}

void World::stepSimulator() { simulator_->step(driven_.moves()); }

void World::collectVehicles(const std::vector<Vehicle>& before) {
  std::unordered_map<std::string_view, double> headings;
  for (const Vehicle& vehicle : before) headings.emplace(vehicle.id, vehicle.state.heading);
  snapshot_.vehicles = driven_.snapshot(simulator_->vehicles());
  for (const SimulatedVehicle& simulated : simulator_->vehicles()) {
    if (driven_.contain(simulated.id)) continue;
    Vehicle vehicle = simulation::asBackground(simulated);
    const auto heading = headings.find(vehicle.id);
    if (heading != headings.end()) {
      vehicle.yaw_rate = core::angleDifference(vehicle.state.heading, heading->second) /
                         setup_.options().simulation_step;
    }
    snapshot_.vehicles.push_back(std::move(vehicle));
  }
  std::unordered_set<std::string_view> present;
  for (const Vehicle& vehicle : snapshot_.vehicles) present.insert(vehicle.id);
  for (const Vehicle& vehicle : before) {
    if (present.count(vehicle.id) == 0) snapshot_.removed.push_back(vehicle.id);
  }
}

void World::takeSnapshot() {
  const core::TimedStage stage("snapshot");
  const std::vector<Vehicle> before = std::move(snapshot_.vehicles);
  snapshot_.removed.clear();
  snapshot_.steering.clear();
  snapshot_.tick += before.empty() ? 0 : 1;
  snapshot_.time = static_cast<double>(snapshot_.tick) * setup_.options().simulation_step;
  collectVehicles(before);
  snapshot_.signals = simulator_->signals();
  TickContacts found = findContacts(snapshot_.vehicles, driven_.size());
  snapshot_.contacts = std::move(found.contacts);
  leaving_ = std::move(found.leaving);
  snapshot_.status = monitor_.update(snapshot_);
  if (snapshot_.status == SessionStatus::kRunning && simulator_->over())
    snapshot_.status = SessionStatus::kCompleted;
  const bool running = snapshot_.status == SessionStatus::kRunning;
  snapshot_.decision_tick = running && snapshot_.tick % setup_.ticksPerDecision() == 0;
  snapshot_.faults = std::move(pending_faults_);
  pending_faults_.clear();
  if (!running) control_.end();
}

}  // namespace cdiff::session
