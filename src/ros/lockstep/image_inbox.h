// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "sensor_msgs/Image.h"

namespace cdiff::ros {

/// Images that came for the vehicles of a node, by tick and slot, and the planning of a decision
/// from them: a vehicle without a usable image gets the fail-safe action and a named fault.
class ImageInbox {
 public:
  ImageInbox() = default;
  /// `camera` says what images must be like, `simulation_step` [s] which tick a stamp means.
  ImageInbox(const rendering::CameraOptions& camera, double simulation_step)
      : camera_(camera), simulation_step_(simulation_step) {}

  /// Keeps an image under the tick nearest to its stamp; the first of a tick counts.
  void add(int slot, const sensor_msgs::Image::ConstPtr& message);
  /// The image of a slot (kEgoSlot: the ego) at a tick; nullptr when none has arrived.
  sensor_msgs::Image::ConstPtr find(int slot, std::uint64_t tick) const;
  /// The image that a vehicle sees at a tick. Throws InputError for one that is not as expected;
  /// there must be one.
  traffic::CameraImage read(int slot, const std::string& vehicle_id, std::uint64_t tick) const;
  /// Drops everything older than a tick.
  void forgetBefore(std::uint64_t tick);

 private:
  rendering::CameraOptions camera_;
  double simulation_step_ = 0.05;
  std::map<std::uint64_t, std::map<int, sensor_msgs::Image::ConstPtr>> images_;
};

/// The outcome of one planning call.
struct PlannerDecision {
  std::vector<planning::PlannedAction> actions;  ///< one per task, in their order
  double latency_ms = 0.0;                       ///< wall time of the planning call
  std::string fault;                             ///< fault of the whole call; empty when none
  double image_age = 0.0;  ///< simulated time from the oldest image to the snapshot [s]
  int missing = 0;         ///< vehicles whose image did not come
  int refused = 0;         ///< vehicles whose image was not as expected
};

/// Asks `planner`, which sees nothing, for all tasks.
PlannerDecision planBlind(planning::Planner& planner, const traffic::TrafficSnapshot& snapshot,
                          const std::vector<planning::PlanningTask>& tasks);

/// Asks `planner` for the tasks whose image at the snapshot's tick is there and as expected; the
/// others get the fail-safe action.
PlannerDecision planSeeing(planning::Planner& planner, const traffic::TrafficSnapshot& snapshot,
                           const std::vector<planning::PlanningTask>& tasks,
                           const ImageInbox& inbox);

}  // namespace cdiff::ros
