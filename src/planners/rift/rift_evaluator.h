// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <vector>

#include "planners/pluto/reference_lines.h"
#include "planners/rift/drivable_mask.h"
#include "planners/rift/rift_rollout.h"

namespace cdiff::planners {

// Simulated returns of RIFT's candidates among forecasts of the others.

/// Another vehicle's forecast: its states 0.1, 0.2, ... 4 s ahead (map frame).
struct RiftNeighbor {
  std::vector<traffic::VehicleState> states;
  traffic::VehicleDimensions size;
};

/// Boxes of the neighbors at each step, in the frame of a RiftPlan, larger than they are: above 1
/// m/s twice as long and up to 1.3 times as wide, growing with time; then all 1.1 times as large
/// (published for RIFT).
class RiftObstacles {
 public:
  RiftObstacles(const std::vector<RiftNeighbor>& neighbors, const Eigen::Vector2d& origin);
  /// Whether a box at a step (0: 0.1 s ahead) overlaps one of them.
  bool hit(std::size_t step, const geometry::OrientedBox& box) const;

 private:
  /// Of one step, by neighbor.
  struct Step {
    std::vector<float> x;
    std::vector<float> y;
    std::vector<float> reach;  ///< half the diagonal [m]
    std::vector<geometry::OrientedBox> boxes;
  };
  std::array<Step, kRiftSteps> steps_;
};

/// A moment whose candidates are to be judged (map frame, SI units).
struct RiftState {
  geometry::Pose2d pose;
  std::vector<double> elevations = {0.0};  ///< z of the route, by meter ahead; then the last
  double speed = 0.0;
  traffic::VehicleDimensions size;
  std::vector<ReferenceLine> lines;
  std::vector<RiftNeighbor> neighbors;
};

/// Simulates each candidate for 4 s by itself and gives its return (RIFT, Chen et al. 2025;
/// docs/rift.md): a collision is an overlap of boxes, off the road is a corner of the box off the
/// drivable area; offset and heading error are those of the planned place from the nearest point of
/// the nearest reference line.
class RiftEvaluator {
 public:
  explicit RiftEvaluator(const dynamics::BicycleModelOptions& vehicle,
                         const planning::PlanTrackerOptions& tracker = {})
      : driver_(vehicle, tracker) {}

  std::vector<double> returnsOf(const RiftState& state,
                                const std::vector<PlutoTrajectory>& candidates,
                                DrivableMask& mask) const;

 private:
  RiftDriver driver_;
};

}  // namespace cdiff::planners
