// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session/driven_vehicles.h"
#include "session/session_control.h"
#include "session/session_setup.h"
#include "simulation/demand_generator.h"

namespace cdiff::session {

// What a session drives in: traffic, driven vehicles, hand-over, contacts.

/// The vehicles around the ego that the simulator drives: as many as the scenario's generated
/// demand asks for, none where the ego starts (map frame, SI units).
class BackgroundTraffic {
 public:
  /// Both must outlive the object.
  BackgroundTraffic(const SessionSetup& setup, simulation::TrafficSimulator& simulator);

  /// Drives before the ego is there; without demand there is nothing to drive.
  void warmUp();
  /// Removes who could not avoid an ego that suddenly is at `start`.
  void clearStart(const traffic::VehicleState& start);
  /// Removes who is too far from the ego (nullptr: from its start) and adds vehicles of generated
  /// demand; `driven` are not the simulator's.
  void keepDensity(const traffic::Vehicle* ego, const DrivenVehicles& driven);

 private:
  void refill(const traffic::Vehicle* ego, const DrivenVehicles& driven, bool warm_up);
  std::vector<traffic::Vehicle> present(const Eigen::Vector2d& center,
                                        const DrivenVehicles& driven);

  const SessionSetup& setup_;
  simulation::TrafficSimulator& simulator_;
  std::unique_ptr<simulation::DemandGenerator> demand_;  ///< nullptr where it is not generated
};

/// The world of a session: the simulator's traffic, the vehicles that we drive through our own
/// dynamics, hand-over between the two, contacts, and the protocol's end rules. Advances tick by
/// tick; decides nothing.
class World {
 public:
  /// Drives the warm-up in SUMO, as the setup starts it, and places the ego: afterward `snapshot()`
  /// is tick 0. `setup` must outlive the world.
  /// Throws InputError for steering that names a lane which is not there.
  explicit World(const SessionSetup& setup);
  /// The same in another simulator, which knows the setup's network.
  World(const SessionSetup& setup, std::unique_ptr<simulation::TrafficSimulator> simulator);

  /// The world at the current tick.
  const traffic::TrafficSnapshot& snapshot() const { return snapshot_; }
  /// What steers the session. What is asked for there enters the world at the next decision, and
  /// its snapshot says so; what cannot be by then is a recorded fault.
  SessionControl& control() { return control_; }

  /// Goes to the next tick. At a decision tick give the selection and the actions decided; between
  /// them nullptr and {}: the last actions are held. Invalid actions become the fail-safe action,
  /// as a recorded fault. A lost simulator ends the session with status kError in a last snapshot;
  /// it does not throw.
  void advance(const cbv::CbvSelection* selection,
               const std::vector<planning::PlannedAction>& actions);

  /// Ends the session from outside (interrupted, a node that died): the next snapshot is the
  /// present one with this status and fault. A session that has just come to its end by itself
  /// takes an error as its status, and nothing else.
  void end(traffic::SessionStatus status, const traffic::Fault& fault);
  /// Where a vehicle that we take over starts to be driven, given its id and where the simulator
  /// had it.
  using TakeOverDisturbance =
      std::function<traffic::VehicleState(const std::string&, const traffic::VehicleState&)>;
  /// For data collection: shifts every vehicle as it is taken over. Without it they begin where
  /// they are.
  void setTakeOverDisturbance(TakeOverDisturbance disturbance) {
    disturbance_ = std::move(disturbance);
  }
  /// Records a fault that was survived; shown in the next snapshot.
  void recordFault(const std::string& source, const std::string& text);

  /// Simulated time at which the ego came to a stand [s]; nullopt while it drives.
  std::optional<double> egoStandsSince() const { return monitor_.standingSince(); }
  /// As long as it is withheld, standing does not end the session; its time counts on.
  void withholdBlocked(bool withheld) { monitor_.withholdBlocked(withheld); }

  /// Version text of the simulator.
  std::string simulatorVersion() const { return simulator_->version(); }
  double routeCompletionPercent() const { return monitor_.routeCompletionPercent(); }

 private:
  void placeEgo();
  VehicleRoles roles() const;
  std::vector<traffic::SteeringChange> changesAt(std::uint64_t tick);
  std::vector<traffic::SteeringChange> steer(std::uint64_t tick);
  void placeVehicle(const PlacedVehicle& vehicle);
  void showSteering(const std::vector<traffic::SteeringChange>& changes);
  void removeContacted(const std::vector<std::string>& removed);
  void applySelection(const cbv::CbvSelection& selection, const std::vector<std::string>& removed);
  void takeOver(const cbv::CbvAssignment& assignment);
  void release(const std::string& id);
  void stepSimulator();
  void collectVehicles(const std::vector<traffic::Vehicle>& before);
  void takeSnapshot();

  const SessionSetup& setup_;
  SessionControl control_;
  std::unique_ptr<simulation::TrafficSimulator> simulator_;
  BackgroundTraffic background_;
  DrivenVehicles driven_;
  ProtocolMonitor monitor_;
  traffic::TrafficSnapshot snapshot_;
  std::vector<traffic::Fault> pending_faults_;
  std::vector<std::string> leaving_;  ///< in contact at the current tick
  TakeOverDisturbance disturbance_;   ///< may be empty
};

}  // namespace cdiff::session
