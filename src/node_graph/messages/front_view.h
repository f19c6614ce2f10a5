// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/planning/planner.h"
#include "rendering/front_camera.h"
#include "sensor_msgs/Image.h"
#include "session/session_setup.h"
#include "video/video_highlights.h"

namespace cdiff::node_graph {

/// A picture for people: what the CBV nearest to the ego sees, rendered larger than its planner
/// gets it and with the planned way of the middle of its box on the road drawn in; before the first
/// CBV what the ego sees, which the picture says. Below it are scenario, time and the colors of the
/// markers.
class FrontView {
 public:
  static constexpr int kWidth = 640;   ///< [px]
  static constexpr int kHeight = 700;  ///< [px], the lines below included

  /// `setup` must outlive the object.
  explicit FrontView(const session::SessionSetup& setup);
  /// `actions` of the decision, or nullptr; rgb8, frame `<vehicle>/camera_optical`.
  sensor_msgs::Image draw(const traffic::TrafficSnapshot& snapshot,
                          const std::vector<planning::PlannedAction>* actions);

 private:
  const session::SessionSetup& setup_;
  rendering::FrontCamera camera_;
  video::FollowedCbv followed_;
};

/// The pixels at which a camera on `vehicle` sees the places of a rollout on the road, as far as
/// they lie ahead of it (x to the right, y down [px]).
std::vector<Eigen::Vector2d> projectedRollout(const rendering::RigCamera& camera,
                                              const traffic::Vehicle& vehicle,
                                              const std::vector<planning::RolloutPoint>& rollout);

}  // namespace cdiff::node_graph
