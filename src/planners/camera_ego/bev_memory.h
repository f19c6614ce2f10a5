// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "planners/camera_ego/bev_encoder.h"
#include "planners/diffusion/image_watch.h"

namespace cdiff::planners {

/// What a camera ego has seen in the last half second: a ring of poses and BEVs of its decisions,
/// from which the one of kPastAge ago is taken. Each BEV is kept as if it had no past: a chain
/// without end is nothing that a training with one or two past looks prepares for. One per vehicle.
class BevMemory {
 public:
  /// `period`: between decisions [s]; kPastAge is a multiple of it.
  explicit BevMemory(double period);

  /// What is given to the encoder: the poses, with the past one where it is remembered, and the
  /// motion.
  EgoPoses posesAt(const traffic::VehicleState& state) const;
  EgoMotion motionAt(const traffic::VehicleState& state, const EgoPoses& poses) const;
  /// BEV of posesAt().past; nullptr where there is none.
  const inference::Rows* past() const;
  /// Ends the decision: keeps its BEV of `width` channels.
  void keep(const traffic::VehicleState& state, const inference::Rows& bev, std::int64_t width);
  /// After a decision without a BEV nothing before it is trusted.
  void forget() { kept_.clear(); }

 private:
  struct Kept {
    geometry::Pose2d pose;
    inference::Rows bev;
  };
  double period_;
  std::size_t age_;  ///< kPastAge in decisions
  std::deque<Kept> kept_;
};

/// The images of a rig's cameras for one vehicle: whether they can be driven by. One camera may see
/// the same while the vehicle moves, as beside a straight edge of the road: they are frozen where
/// none of them changes.
class RigWatch {
 public:
  /// Sizes are those of the rig's cameras; `frozen_image_time` [s] counts for rigs that see.
  RigWatch(const rendering::CameraRig& rig, double frozen_image_time, double simulation_step);
  /// What is wrong with the images of a task at a tick: camera and reason; empty when nothing.
  std::string fault(const planning::PlanningTask& task, std::uint64_t tick);
  /// Pixels by camera of a task without a fault, in the rig's order.
  std::vector<const std::uint8_t*> pixels(const planning::PlanningTask& task) const;

 private:
  std::vector<std::string> names_;
  std::vector<ImageExpectation> expectations_;
  std::vector<ImageWatch> watches_;
  ImageExpectation expected_strip_;
  ImageWatch strip_;  ///< of all images, one below the other
};

}  // namespace cdiff::planners
