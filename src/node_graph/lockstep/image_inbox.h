// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/planning/planner.h"
#include "sensor_msgs/Image.h"
#include "session/vehicle_rigs.h"

namespace cdiff::node_graph {

/// Images that came for the vehicles of a node, by tick and slot, and the planning of a decision
/// from them: a vehicle without usable images gets the fail-safe action and a named fault.
class ImageInbox {
 public:
  ImageInbox() = default;
  /// `rigs` say which images come and what they must be like, `simulation_step` [s] which tick a
  /// stamp means.
  ImageInbox(const session::VehicleRigs& rigs, double simulation_step)
      : rigs_(rigs), simulation_step_(simulation_step) {}

  const session::VehicleRigs& rigs() const { return rigs_; }
  /// Keeps an image under the tick nearest to its stamp; the first of a tick and camera counts.
  void add(int slot, const sensor_msgs::Image::ConstPtr& message,
           const std::string& camera = rendering::kFrontCamera);
  /// The image of a slot (kEgoSlot: the ego) at a tick; nullptr when none has arrived.
  sensor_msgs::Image::ConstPtr find(int slot, std::uint64_t tick,
                                    const std::string& camera = rendering::kFrontCamera) const;
  /// Whether the images of all cameras of a slot have arrived.
  bool complete(int slot, std::uint64_t tick) const;
  /// The image that a vehicle sees at a tick. Throws InputError for one that is not as expected;
  /// there must be one, of a camera of its rig.
  traffic::CameraImage read(int slot, const std::string& vehicle_id, std::uint64_t tick,
                            const std::string& camera = rendering::kFrontCamera) const;
  /// Drops everything older than a tick.
  void forgetBefore(std::uint64_t tick);

 private:
  using ByCamera = std::map<std::pair<int, std::string>, sensor_msgs::Image::ConstPtr>;
  session::VehicleRigs rigs_;
  double simulation_step_ = 0.05;
  std::map<std::uint64_t, ByCamera> images_;  ///< by tick; then slot and camera
};

/// The outcome of one planning call.
struct PlannerDecision {
  std::vector<planning::PlannedAction> actions;  ///< one per task, in their order
  double latency_ms = 0.0;                       ///< wall time of the planning call
  std::string fault;                             ///< fault of the whole call; empty when none
  double image_age = 0.0;  ///< simulated time from the oldest image to the snapshot [s]
  int missing = 0;         ///< vehicles of which an image did not come
  int refused = 0;         ///< vehicles of which an image was not as expected
};

/// Asks `planner`, which sees nothing, for all tasks.
PlannerDecision planBlind(planning::Planner& planner, const traffic::TrafficSnapshot& snapshot,
                          const std::vector<planning::PlanningTask>& tasks);

/// Asks `planner` for the tasks whose images at the snapshot's tick are there and as expected; the
/// others get the fail-safe action.
PlannerDecision planSeeing(planning::Planner& planner, const traffic::TrafficSnapshot& snapshot,
                           const std::vector<planning::PlanningTask>& tasks,
                           const ImageInbox& inbox);

}  // namespace cdiff::node_graph
