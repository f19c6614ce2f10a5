// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <array>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "planners/pluto/pluto_network.h"
#include "planners/rift/rift_reward.h"
#include "planning/plan_tracker.h"

namespace cdiff::planners {

/// A candidate's places and directions as they are to be driven, in a frame that is parallel to the
/// map's, its origin where the vehicle is [m].
struct RiftPlan {
  std::array<Eigen::Vector2d, static_cast<std::size_t>(kPlutoSteps)> places;
  std::array<Eigen::Vector2d, kRiftSteps> directions;  ///< of any length

  RiftPlan(const PlutoTrajectory& candidate, double heading);
};

/// A vehicle's motion at 0, 0.1, ... 4 s in the frame of its plan (SI units); headings are not
/// wrapped.
struct RiftRollout {
  RiftSeries x{};
  RiftSeries y{};
  RiftSeries heading{};
  RiftSeries speed{};
};

/// Drives candidates as PlanTracker drives plans, through the project's vehicle dynamics, 0.05 s a
/// step: what is left of the plan is followed at each decision, and errors start over.
class RiftDriver {
 public:
  explicit RiftDriver(const dynamics::BicycleModelOptions& vehicle,
                      const planning::PlanTrackerOptions& tracker = {});
  /// From `heading` [rad] and `speed` [m/s].
  RiftRollout drive(const RiftPlan& plan, double heading, double speed) const;

 private:
  dynamics::BicycleModel model_;
  planning::PlanTrackerOptions tracker_;
};

}  // namespace cdiff::planners
