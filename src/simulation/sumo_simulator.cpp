// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/sumo_simulator.h"

#include <algorithm>
#include <optional>
#include <set>

#include "core/stage_times.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "simulation/driven_fleet.h"
#include "simulation/person_observer.h"
#include "simulation/sumo_link.h"
#include "simulation/sumo_start.h"
#include "simulation/traffic_observer.h"
#include "simulation/traffic_simulator.h"

namespace cdiff::simulation {
namespace {

// Bits of SUMO's speed mode: 1 safe speed, 2 largest acceleration, 4 largest deceleration, 8 right
// of way, 16 red lights.
constexpr int kUsualSpeedMode = 31;
constexpr int kDisregardRightOfWay = 23;

}  // namespace

const SimulatedVehicle* findVehicle(const std::vector<SimulatedVehicle>& vehicles,
                                    const std::string& id) {
  const auto found = std::lower_bound(
      vehicles.begin(), vehicles.end(), id,
      [](const SimulatedVehicle& vehicle, const std::string& key) { return vehicle.id < key; });
  return found != vehicles.end() && found->id == id ? &*found : nullptr;
}

traffic::Vehicle asBackground(const SimulatedVehicle& simulated) {
  traffic::Vehicle vehicle;
  vehicle.id = simulated.id;
  vehicle.state = simulated.state;
  vehicle.dimensions = simulated.dimensions;
  vehicle.acceleration = simulated.acceleration;
  vehicle.lane_id = simulated.lane_id;
  return vehicle;
}

void SumoOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"binary", "", "Program of SUMO to start."}, binary, {});
  visitor.number(
      {"start_timeout", "s", "Wall time within which SUMO must listen and have loaded its input."},
      start_timeout, 0.1, 3600.0);
  visitor.number({"step_timeout", "s", "Wall time after which a step counts as a frozen SUMO."},
                 step_timeout, 0.1, 3600.0);
  visitor.number({"match_threshold", "m",
                  "How far from a lane SUMO looks for one for a vehicle that is moved."},
                 match_threshold, 1.0, 1000.0);
}

/// Everything behind the simulator: the session with SUMO, what it reports and what we move.
class SumoSimulator::Connection {
 public:
  Connection(const SumoOptions& options, const SumoSession& session,
             const map::RoadNetwork& network)
      : session_(session),
        step_(session.simulation_step),
        graph_(network),
        started_(startSumo(options, session)),
        link_(*started_),
        calls_(link_.calls()),
        observer_(calls_),
        fleet_(link_, graph_, options.match_threshold, session.simulation_step) {
    link_.guarded("start", [&] { observer_.start(session.lights_green); });
    if (hasPersons(session.demand_file)) persons_.emplace(calls_);
    if (session.lights_green) right_of_way_.emplace(network, observer_.signals());
  }

  SumoLink& link() { return link_; }
  TrafficObserver& observer() { return observer_; }

  void addDriven(const std::string& id, const traffic::VehicleDimensions& dimensions,
                 const DrivenVehicle& start) {
    DrivenVehicle named = start;
    named.id = id;
    link_.guarded("adding vehicle '" + id + "'",
                  [&] { fleet_.add(named, dimensions, typeFor(dimensions)); });
    observer_.watch(id);
    fresh_.insert(id);
  }

  void takeOver(const std::string& id) {
    const SimulatedVehicle* vehicle = observer_.find(id);
    if (vehicle == nullptr)
      throw core::SimulatorError("SUMO has no vehicle '" + id + "' to take over");
    const SimulatedVehicle taken = *vehicle;
    link_.guarded("taking over '" + id + "'", [&] { fleet_.takeOver(taken); });
  }

  bool release(const DrivenVehicle& vehicle) {
    if (!fleet_.contains(vehicle.id)) {
      throw core::SimulatorError("vehicle '" + vehicle.id +
                                 "' is released but is not driven by us");
    }
    const bool released =
        link_.guarded("releasing '" + vehicle.id + "'", [&] { return fleet_.release(vehicle); });
    if (!released) remove(vehicle.id);
    return released;
  }

  void remove(const std::string& id) {
    fleet_.forget(id);
    fresh_.erase(id);
    link_.guarded("removing '" + id + "'", [&] { takeOut(id); });
  }

  void step(const std::vector<DrivenVehicle>& driven) {
    try {
      for (const DrivenVehicle& vehicle : driven) bringBack(vehicle);
      link_.guarded("step", [&] { guardedStep(driven); });
    } catch (const SumoRefusal& refusal) {
      if (namesDemand(refusal.what(), session_)) refuseDemand(session_, refusal.what());
      throw;
    }
    fresh_.clear();
  }

  bool addBackground(const std::string& id, const std::vector<std::string>& edges,
                     double depart_position, int depart_lane, double depart_speed,
                     const traffic::VehicleDimensions& dimensions) {
    const std::string route_id = "route_" + id;
    const bool added = link_.guarded("adding vehicle '" + id + "'", [&] {
      return link_.attempt([&] {
        calls_.addRoute(route_id, edges);
        calls_.addVehicle(id, route_id, typeFor(dimensions),
                          {std::to_string(depart_lane), core::formatNumber(depart_position),
                           core::formatNumber(depart_speed)});
      });
    });
    if (added) waiting_.push_back(id);
    return added;
  }

 private:
  void guardedStep(const std::vector<DrivenVehicle>& driven) {
    {
      const core::TimedStage stage("moves");
      for (const DrivenVehicle& vehicle : driven) fleet_.move(vehicle);
    }
    {
      const core::TimedStage stage("sumo_step");
      calls_.step();
    }
    {
      const core::TimedStage stage("reading");
      observer_.read();
      fleet_.report(observer_.correctable());
    }
    dropWaiting();
    {
      const core::TimedStage stage("right_of_way");
      grantRightOfWay();
    }
    if (persons_) persons_->addTo(observer_.correctable());
  }

  /// SUMO takes a moved vehicle out when it believes that it has arrived; it goes on where we say.
  void bringBack(const DrivenVehicle& vehicle) {
    if (!fleet_.contains(vehicle.id) || fresh_.count(vehicle.id) != 0) return;
    if (observer_.find(vehicle.id) != nullptr) return;
    const traffic::VehicleDimensions dimensions = fleet_.dimensions(vehicle.id);
    addDriven(vehicle.id, dimensions, vehicle);
  }

  /// Where all lights are green, lets those go who would wait for each other forever.
  void grantRightOfWay() {
    if (!right_of_way_) return;
    const auto is_driven = [this](const std::string& id) { return fleet_.contains(id); };
    const RightOfWayChanges changes = right_of_way_->update(observer_.vehicles(), is_driven, step_);
    for (const RightOfWayChange& change : changes.vehicles) {
      if (observer_.find(change.vehicle_id) == nullptr || fleet_.contains(change.vehicle_id))
        continue;
      calls_.setSpeedMode(change.vehicle_id,
                          change.may_go ? kDisregardRightOfWay : kUsualSpeedMode);
    }
    for (const traffic::SignalState& signal : changes.signals) {
      calls_.setLightState(signal.id, signal.state);
      observer_.show(signal);
    }
  }

  /// Background vehicles that found no room in the step just made are not tried again.
  void dropWaiting() {
    for (const std::string& id : waiting_) {
      if (observer_.find(id) != nullptr) continue;
      takeOut(id);
    }
    waiting_.clear();
  }

  /// A subscription to a vehicle that is taken out makes SUMO's next step fail, so it ends first.
  /// No error when it is gone already.
  void takeOut(const std::string& id) {
    if (persons_ && persons_->contains(id)) {
      link_.attempt([&] { persons_->remove(id); });
      return;
    }
    if (observer_.find(id) != nullptr) {
      link_.attempt([&] { calls_.unsubscribe(id); });
    }
    link_.attempt([&] { calls_.removeVehicle(id); });
  }

  /// One vehicle type per size: SUMO's passenger car without dawdling; drivers differ by SUMO's
  /// seeded speed factor.
  std::string typeFor(const traffic::VehicleDimensions& dimensions) {
    const std::string id = "car_" + core::formatNumber(dimensions.length) + "_" +
                           core::formatNumber(dimensions.width) + "_" +
                           core::formatNumber(dimensions.height);
    if (types_.insert(id).second) calls_.addType(id, dimensions);
    return id;
  }

  SumoSession session_;
  double step_;
  EdgeGraph graph_;
  std::unique_ptr<SumoLink> started_;
  SumoLink& link_;
  const SumoCalls& calls_;
  TrafficObserver observer_;
  DrivenFleet fleet_;
  std::optional<PersonObserver> persons_;   ///< where the demand has some
  std::optional<RightOfWay> right_of_way_;  ///< when all lights are green
  std::set<std::string> fresh_;             ///< added since the last step
  std::vector<std::string> waiting_;        ///< background vehicles added since the last step
  std::set<std::string> types_;
};

SumoSimulator::SumoSimulator(const SumoOptions& options, const SumoSession& session,
                             const map::RoadNetwork& network)
    : connection_(std::make_unique<Connection>(options, session, network)) {}

SumoSimulator::~SumoSimulator() = default;

void SumoSimulator::addDriven(const std::string& id, const traffic::VehicleDimensions& dimensions,
                              const DrivenVehicle& start) {
  connection_->addDriven(id, dimensions, start);
}

void SumoSimulator::takeOver(const std::string& id) { connection_->takeOver(id); }

bool SumoSimulator::release(const DrivenVehicle& vehicle) { return connection_->release(vehicle); }

void SumoSimulator::remove(const std::string& id) { connection_->remove(id); }

void SumoSimulator::step(const std::vector<DrivenVehicle>& driven) { connection_->step(driven); }

const std::vector<SimulatedVehicle>& SumoSimulator::vehicles() const {
  return connection_->observer().vehicles();
}

const std::vector<traffic::SignalState>& SumoSimulator::signals() const {
  return connection_->observer().signals();
}

std::string SumoSimulator::version() const { return connection_->link().version(); }

int SumoSimulator::processId() const { return connection_->link().processId(); }

bool SumoSimulator::addBackground(const std::string& id, const std::vector<std::string>& edges,
                                  double depart_position, int depart_lane, double depart_speed,
                                  const traffic::VehicleDimensions& dimensions) {
  return connection_->addBackground(id, edges, depart_position, depart_lane, depart_speed,
                                    dimensions);
}

}  // namespace cdiff::simulation
