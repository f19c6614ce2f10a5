// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A session of data collection in one process: as session::ClosedLoop, but many background
/// vehicles are driven, each on a route of its own, and what drives is disturbed and recovers.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collection/perturbed_planner.h"
#include "collection/traffic_driver.h"
#include "rendering/front_camera.h"
#include "session/session_observer.h"
#include "session/world.h"

namespace cdiff::collection {

/// The scenario as collection runs it: its protocol ends it only after the duration (or with the
/// ego's route); lights and density of generated demand are drawn from the seed, and every other
/// seed generates the demand of a scenario that brings a file. PDM-Lite, the expert, takes the
/// place of planners that learn from it.
session::ScenarioOptions collectionScenario(session::ScenarioOptions scenario,
                                            const CollectionOptions& options);

/// Its set-up, with the ego route lengthened by random turns to what the duration needs.
std::unique_ptr<session::SessionSetup> collectionSetup(const session::ScenarioOptions& scenario,
                                                       const CollectionOptions& options);

class CollectionLoop {
 public:
  /// `setup` must outlive the loop. `images`: whether records hold what vehicles see, every
  /// image_period, those of different slots at different decisions, and soon after a disturbance.
  /// Throws InputError for unknown
  /// planners and planners that need images.
  CollectionLoop(const session::SessionSetup& setup, const CollectionOptions& options, bool images);
  ~CollectionLoop();

  /// Observers are called in the order added and must outlive the run.
  void addObserver(session::SessionObserver& observer) { observers_.push_back(&observer); }
  /// Runs to the end; `stop` ends the session as interrupted.
  traffic::SessionStatus run(const std::atomic<bool>& stop);
  const session::World& world() const { return *world_; }
  /// Whether the last action decided for a vehicle carries noise.
  bool perturbed(const std::string& vehicle_id) const;

 private:
  struct Decision;
  Decision decide();
  void render(Decision& decision);
  bool imageDue(const planning::PlannedAction& action, std::int64_t decision);
  std::unique_ptr<PerturbedPlanner> perturbedPlanner(std::unique_ptr<planning::Planner> planner,
                                                     const std::string& name) const;

  const session::SessionSetup& setup_;
  CollectionOptions options_;
  std::uint64_t seed_;
  std::unique_ptr<session::World> world_;
  TrafficDriver driver_;
  std::unique_ptr<PerturbedPlanner> ego_planner_;
  std::unique_ptr<PerturbedPlanner> cbv_planner_;
  std::optional<rendering::FrontCamera> camera_;
  std::map<std::string, std::int64_t> disturbed_;  ///< last decision with noise or take-over
  std::vector<session::SessionObserver*> observers_;
};

}  // namespace cdiff::collection
