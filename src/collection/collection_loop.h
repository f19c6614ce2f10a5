// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "collection/collection_options.h"
#include "collection/driver.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "session/closed_loop.h"
#include "session/vehicle_cameras.h"

namespace cdiff::collection {

// A session that is driven to be recorded: who drives what in it, and how that is disturbed.

/// A planner that drives now and then in data collection, and what it sees by.
struct Policy {
  std::unique_ptr<planning::Planner> planner;
  std::unique_ptr<session::VehicleCameras> cameras;  ///< nullptr: it needs no images
};

/// Wraps another planner: gives each vehicle its own target speed [m/s], and now
/// and then adds a burst of noise to an action, stops the vehicle for some seconds, or lets a
/// policy drive it, so that the record shows how the planner recovers and starts, and what it does
/// where the policy leads (DAgger; Ross et al. 2011, with time slices in place of single actions).
class PerturbedPlanner : public planning::Planner {
 public:
  /// Draws are keyed by vehicle id and number of its bursts. `decision_period` [s] decides whether
  /// a decision was left out. Without a policy none drives.
  PerturbedPlanner(std::unique_ptr<planning::Planner> planner, const CollectionOptions& options,
                   std::uint64_t seed, double decision_period, Policy policy = {});

  /// The noise of a vehicle that was not among the tasks of the last decision starts over.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

  Driver driverOf(const std::string& vehicle_id) const {
    return collection::driverOf(options_, seed_, vehicle_id);
  }
  /// Whether the policy drives the vehicle at this time [s].
  bool policyDrives(const std::string& vehicle_id, double time) const;

  /// Vehicles whose actions of the last call carry noise, or are the policy's.
  const std::set<std::string>& perturbed() const { return perturbed_; }

 private:
  struct Burst {
    std::uint32_t count = 0;  ///< number of the vehicle's bursts so far
    double begin = 0.0;       ///< [s]
    double end = 0.0;         ///< [s]
    double steer = 0.0;       ///< in [-1, 1], of the largest
    double pedal = 0.0;       ///< in [-1, 1], of the largest; positive is throttle
    bool stall = false;       ///< stops the vehicle instead
    bool begun = false;       ///< has acted; a stall that finds a standing vehicle never does
  };
  /// Puts the policy's actions in place of the planner's where it drives.
  void takePolicy(const traffic::TrafficSnapshot& snapshot,
                  const std::vector<planning::PlanningTask>& asked,
                  std::vector<planning::PlannedAction>& actions);
  Burst drawn(const std::string& vehicle, std::uint32_t count, double after) const;
  bool acts(double time, double speed, Burst& burst) const;
  void disturb(const Burst& burst, double speed, traffic::ControlAction& action) const;

  std::unique_ptr<planning::Planner> planner_;
  Policy policy_;
  CollectionOptions options_;
  std::uint64_t seed_;
  core::RandomStream noise_;
  core::RandomStream spells_;
  double decision_period_;
  double last_time_ = 0.0;  ///< time of the last call [s]
  std::map<std::string, Burst> bursts_;
  std::set<std::string> perturbed_;
};

/// Place and heading of a vehicle that is taken over, disturbed; the same for the same arguments.
traffic::VehicleState disturbedStart(const NoiseOptions& options, std::uint64_t seed,
                                     std::uint64_t tick, const std::string& vehicle,
                                     const traffic::VehicleState& state);

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
  /// ImageSchedule defines it. Throws InputError for unknown planners, planners that need images
  /// (the policy may), and a real_time_factor.
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
  Driver driverOf(const std::string& vehicle_id) const {
    return cbv_planner_->driverOf(vehicle_id);
  }

 private:
  session::LoopParts makeParts(const session::SessionSetup& setup, const CollectionOptions& options,
                               bool images);

  ImageSchedule schedule_;
  const PerturbedPlanner* ego_planner_ = nullptr;  ///< the loop's planner of the ego
  const PerturbedPlanner* cbv_planner_ = nullptr;  ///< the loop's planner of the CBVs
  session::ClosedLoop loop_;
};

}  // namespace cdiff::collection
