// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "session/observer_thread.h"
#include "session/session_observer.h"
#include "session/vehicle_cameras.h"
#include "session/world.h"

namespace cdiff::session {

// The decision cycle of a session in one process.

/// One process asks its planners one after the other, so no answer can be late: throws InputError
/// for options with a real-time factor.
void requireLockstep(const ScenarioOptions& options);

/// Tasks of the CBV planner at a decision: one per assigned slot whose vehicle is in the snapshot,
/// in slot order, each with `target_speed` [m/s], or where there is none with the one that `setup`
/// has for the vehicle.
std::vector<planning::PlanningTask> cbvTasks(const traffic::TrafficSnapshot& snapshot,
                                             const cbv::CbvSelection& selection,
                                             const SessionSetup& setup,
                                             std::optional<double> target_speed = {});
/// Lets `cbvs` follow the changes of a snapshot, and the planner of the CBVs the guidance that they
/// make. Returns why it follows the guidance before on; empty when it does not.
std::string steerPlanner(const std::vector<traffic::SteeringChange>& changes, SteeredCbvs& cbvs,
                         planning::Planner& planner);
/// Task of the ego planner; empty when the ego is gone.
std::vector<planning::PlanningTask> egoTasks(const traffic::TrafficSnapshot& snapshot,
                                             const map::Route& route, double target_speed);
/// Runs a planner and times it. A planner that throws or answers for the wrong vehicles yields
/// fail-safe actions; the text of the fault goes to `fault` (empty when none).
std::vector<planning::PlannedAction> planTimed(planning::Planner& planner,
                                               const traffic::TrafficSnapshot& snapshot,
                                               const std::vector<planning::PlanningTask>& tasks,
                                               double& milliseconds, std::string& fault);

/// Whether the record of a decision also shows what the vehicle of a slot (or traffic::kEgoSlot)
/// sees, whose planner does not ask for it; asked once for each action of a decision, in order.
using ImageWish = std::function<bool(const traffic::TrafficSnapshot& snapshot,
                                     const traffic::Vehicle& vehicle, int slot)>;

/// A planner, and whether its descriptor says that its tasks come with images.
struct LoopPlanner {
  std::unique_ptr<planning::Planner> planner;
  bool sees = false;
};

/// What drives a session.
struct LoopParts {
  std::unique_ptr<World> world;  ///< nullptr: over SUMO, as the setup starts it
  std::unique_ptr<cbv::VehicleSelector> selector;
  LoopPlanner ego_planner;
  LoopPlanner cbv_planner;                ///< of every vehicle that is selected
  std::optional<VehicleCameras> cameras;  ///< for planners that see and for `image_wish`
  ImageWish image_wish;                   ///< empty: no other images
};

/// The parts that the scenario names, without a world: CBV identification, its planners, cameras
/// where one of them sees. Throws InputError for unknown planners and the external ego, which needs
/// the node graph.
LoopParts makeParts(const SessionSetup& setup);

/// The decision cycle of a session in one process, without ROS: it defines what the node graph
/// does. At each decision tick: selection of the vehicles to drive, planners of ego and CBVs on the
/// same snapshot, then the world advances.
class ClosedLoop {
 public:
  /// With makeParts(setup). `setup` must outlive the loop. Throws InputError as makeParts does, and
  /// for a real_time_factor, which needs the node graph.
  explicit ClosedLoop(const SessionSetup& setup);
  ClosedLoop(const SessionSetup& setup, LoopParts parts);
  ~ClosedLoop();

  /// Observers are called in the order added and must outlive the run.
  void addObserver(SessionObserver& observer) { observers_.push_back(&observer); }
  /// Observers are called in a thread of their own, which may lag behind the session, but not
  /// beyond the end of `run`. They must use nothing that the session changes but what they are
  /// given.
  void observeBeside() { beside_ = true; }
  /// Runs to the end; `stop` (from a signal handler) ends the session as interrupted.
  traffic::SessionStatus run(const std::atomic<bool>& stop);
  const World& world() const { return *parts_.world; }
  /// What steers the session, from any thread.
  SessionControl& control() { return parts_.world->control(); }

 private:
  struct Decision;
  struct Tick;
  bool holdBack(const std::atomic<bool>& stop);
  Decision decide();
  bool fill(Tick& tick);
  void show(const std::shared_ptr<Tick>& tick, ObserverThread* beside);
  void steer(const std::vector<traffic::SteeringChange>& changes);
  void ask(const LoopPlanner& asked, const std::string& name,
           std::vector<planning::PlanningTask> tasks, Decision& decision);
  void render(const traffic::Vehicle& vehicle, int slot, Decision& decision);
  void renderWishes(Decision& decision);

  const SessionSetup& setup_;
  LoopParts parts_;
  SteeredCbvs steered_;
  std::vector<SessionObserver*> observers_;
  bool beside_ = false;
};

}  // namespace cdiff::session
