// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/pluto/pluto_network.h"
#include "planners/pluto/pluto_scene.h"
#include "planners/pluto/tracks.h"
#include "planning/plan_tracker.h"
#include "planning/route_follower.h"
#include "planning/vehicle_memory.h"

namespace cdiff::planners {

/// Options of the planner: its weights, how it chooses, and how it follows what it chose.
struct PlutoOptions : WeightOptions {
  std::int64_t top = 10;     ///< candidates that share the probability, those of largest logits
  double free_score = 0.25;  ///< of the plan that follows no reference line
  planning::PlanTrackerOptions tracker;

  PlutoOptions() : WeightOptions{kPluto.planner} {}
  void describe(core::OptionsVisitor& visitor);
  void validate() const { tracker.validate(); }
};

/// Which plan drives: a candidate, or the free plan, which comes last.
struct PlutoChoice {
  std::size_t index = 0;       ///< candidates.size(): the free plan
  std::vector<double> scores;  ///< by candidate, then of the free plan
};

/// As RIFT executes it (Chen et al. 2025): softmax over the `top` largest logits (ties by number),
/// 0 for the others, and `free_score` for the free plan; the first of the largest scores wins.
PlutoChoice choosePlan(const std::vector<float>& logits, std::size_t top, double free_score);

/// Pluto: a transformer over neighbors, lanes and reference lines weighs trajectories; PIDs follow
/// the best (docs/pluto.md). Remembers the last two seconds of decisions.
class PlutoPlanner : public planning::Planner {
 public:
  /// `network` must outlive the planner. `period`: between decisions [s].
  PlutoPlanner(const PlutoOptions& options, const PlutoModel& model,
               const map::RoadNetwork& network, double period);

  /// Memory is kept by vehicle and dropped when it is not among the tasks. A vehicle without a
  /// route, and every vehicle where a state in the snapshot is not finite, gets the fail-safe
  /// action and a fault.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  struct Memory {
    planning::RouteFollower follower;
    planning::PlanTracker tracker;
  };
  PlutoOutput look(const traffic::TrafficSnapshot& snapshot, const planning::PlanningTask& task,
                   double arc_length);
  void conclude(const planning::PlanningTask& task, const PlutoOutput& output, Memory& memory,
                planning::PlannedAction& planned) const;

  PlutoOptions options_;
  PlutoSceneBuilder builder_;
  PlutoNetwork network_;
  RecentTracks tracks_;
  planning::VehicleMemory<Memory> memories_;
};

/// The planner of a kind, whose options are `options`. Throws InputError for weights that are
/// missing or do not fit, and for a decision period other than 0.1 s.
std::unique_ptr<planning::Planner> makePluto(const WeightKind& kind, const PlutoOptions& options,
                                             const planning::PlannerParts& parts);

/// The descriptor of `pluto`, and that of `rift` but for title, help and options.
template <class Options>
planning::PlannerDescriptor plutoDescriptorOf(const WeightKind& kind) {
  planning::PlannerDescriptor descriptor =
      learnedDescriptor<Options>(kind, {"vehicles_map_route", "one pass of the network"});
  descriptor.make = [kind](const planning::PlannerParts& parts) {
    return makePluto(kind, parts.options.of<Options>(), parts);
  };
  return descriptor;
}

}  // namespace cdiff::planners
