// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "collection/perturbed_planner.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "session/closed_loop.h"

namespace cdiff::collection {

/// When a driven vehicle's front view is recorded: once a period, slot after slot, and soon after a
/// disturbance of it, for what it does then is worth more than what it does most of the time.
class ImageSchedule {
 public:
  /// `period`: decisions between two images of a vehicle; at least one is taken.
  explicit ImageSchedule(std::int64_t period);

  /// Whether the vehicle of a slot (or traffic::kEgoSlot) has its turn at the decision of this
  /// number; call once for each. `noisy`: its action of this decision carries noise. Never at the
  /// take-over itself, so that no jump lies between image and motion.
  bool due(const traffic::Vehicle& vehicle, int slot, std::int64_t decision, bool noisy);

 private:
  std::int64_t period_;
  std::map<std::string, std::int64_t> disturbed_;  ///< last decision with noise or take-over
};

/// A session of data collection in one process: the cycle of session::ClosedLoop, in which many
/// background vehicles are driven, each on a route of its own, and what drives is disturbed and
/// recovers.
class CollectionLoop {
 public:
  /// `setup` must outlive the loop. `images`: whether records hold what vehicles see, as
  /// ImageSchedule has it. Throws InputError for unknown planners, planners that need images, and a
  /// real_time_factor.
  CollectionLoop(const session::SessionSetup& setup, const CollectionOptions& options, bool images);
  CollectionLoop(const CollectionLoop&) = delete;
  CollectionLoop& operator=(const CollectionLoop&) = delete;

  /// Observers are called in the order added and must outlive the run.
  void addObserver(session::SessionObserver& observer) { loop_.addObserver(observer); }
  /// Runs to the end; `stop` ends the session as interrupted.
  traffic::SessionStatus run(const std::atomic<bool>& stop) { return loop_.run(stop); }
  const session::World& world() const { return loop_.world(); }
  /// Whether the last action decided for a vehicle carries noise.
  bool perturbed(const std::string& vehicle_id) const;

 private:
  session::LoopParts makeParts(const session::SessionSetup& setup, const CollectionOptions& options,
                               bool images);

  ImageSchedule schedule_;
  const PerturbedPlanner* ego_planner_ = nullptr;  ///< the loop's planner of the ego
  const PerturbedPlanner* cbv_planner_ = nullptr;  ///< the loop's planner of the CBVs
  session::ClosedLoop loop_;
};

}  // namespace cdiff::collection
