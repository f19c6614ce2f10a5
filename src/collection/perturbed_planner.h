// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>

#include "collection/collection_options.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/planning/planner.h"

namespace cdiff::collection {

/// Wraps another planner: gives each vehicle its own target speed [m/s] and driving style, and now
/// and then adds a burst of noise to an action or stops the vehicle for some seconds, so that the
/// record shows how the planner recovers and starts.
class PerturbedPlanner : public planning::Planner {
 public:
  /// Draws are keyed by vehicle id and count of its bursts. `decision_period` [s] decides whether a
  /// decision was left out.
  PerturbedPlanner(std::unique_ptr<planning::Planner> planner, const CollectionOptions& options,
                   std::uint64_t seed, double decision_period);

  /// The noise of a vehicle that was not among the tasks of the last decision starts over.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;
  bool needsImages() const override { return planner_->needsImages(); }

  /// Vehicles whose actions of the last call carry noise.
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
  planning::DrivingStyle styleOf(const core::RandomKey& key) const;
  Burst drawn(const std::string& vehicle, std::uint32_t count, double after) const;
  bool acts(double time, double speed, Burst& burst) const;
  void disturb(const Burst& burst, double speed, traffic::ControlAction& action) const;

  std::unique_ptr<planning::Planner> planner_;
  CollectionOptions options_;
  core::RandomStream noise_;
  core::RandomStream styles_;
  double decision_period_;
  double last_time_ = 0.0;  ///< time of the last call [s]
  std::map<std::string, Burst> bursts_;
  std::set<std::string> perturbed_;
};

/// Place and heading of a vehicle that is taken over, disturbed; the same for the same arguments.
traffic::VehicleState disturbedStart(const NoiseOptions& options, std::uint64_t seed,
                                     std::uint64_t tick, const std::string& vehicle,
                                     const traffic::VehicleState& state);

}  // namespace cdiff::collection
