// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The decision cycle of a session in one process, without ROS: it defines what the node graph
/// does. At each decision tick: CBV identification, planners of ego and CBVs on the same snapshot,
/// then the world advances.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "rendering/front_camera.h"
#include "session/session_observer.h"
#include "session/world.h"

namespace cdiff::session {

/// One process asks its planners one after the other, so no answer can be late: throws InputError
/// for options with a real-time factor.
void requireLockstep(const ScenarioOptions& options);

/// Tasks of the CBV planner at a decision: one per assigned slot whose vehicle is in the snapshot,
/// in slot order.
std::vector<planning::PlanningTask> cbvTasks(const traffic::TrafficSnapshot& snapshot,
                                             const cbv::CbvSelection& selection,
                                             double target_speed);
/// Task of the ego planner; empty when the ego is gone.
std::vector<planning::PlanningTask> egoTasks(const traffic::TrafficSnapshot& snapshot,
                                             const map::Route& route, double target_speed);
/// Gives each task the image of its slot; tasks without one stay without.
void attachImages(const std::vector<SlotImage>& images, std::vector<planning::PlanningTask>& tasks);
/// Runs a planner and times it. A planner that throws or answers for the wrong vehicles yields
/// fail-safe actions; the text of the fault goes to `fault` (empty when none).
std::vector<planning::PlannedAction> planTimed(planning::Planner& planner,
                                               const traffic::TrafficSnapshot& snapshot,
                                               const std::vector<planning::PlanningTask>& tasks,
                                               double& milliseconds, std::string& fault);

class ClosedLoop {
 public:
  /// `setup` must outlive the loop. Throws InputError for unknown planners, and for the external
  /// ego and a real_time_factor, which need the node graph.
  explicit ClosedLoop(const SessionSetup& setup);
  /// The same in a world of its own; nullptr: over SUMO.
  ClosedLoop(const SessionSetup& setup, std::unique_ptr<World> world);
  ~ClosedLoop();

  /// Observers are called in the order added and must outlive the run.
  void addObserver(SessionObserver& observer) { observers_.push_back(&observer); }
  /// Runs to the end; `stop` (from a signal handler) ends the session as interrupted.
  traffic::SessionStatus run(const std::atomic<bool>& stop);
  const World& world() const { return *world_; }

 private:
  struct Decision;
  Decision decide();
  void ask(planning::Planner& planner, const std::string& name,
           std::vector<planning::PlanningTask> tasks, Decision& decision);
  void render(const std::vector<planning::PlanningTask>& tasks, std::vector<SlotImage>& images);
  const SessionSetup& setup_;
  std::unique_ptr<World> world_;
  std::unique_ptr<cbv::CbvSelector> selector_;
  std::unique_ptr<planning::Planner> ego_planner_;
  std::unique_ptr<planning::Planner> cbv_planner_;
  std::optional<rendering::FrontCamera> camera_;  ///< where a planner sees
  std::vector<SessionObserver*> observers_;
};

}  // namespace cdiff::session
