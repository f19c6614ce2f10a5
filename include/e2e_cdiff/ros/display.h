// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What people and tools look at, besides the session's own messages: /ego/odometry and tf of ego
/// and CBVs (`map` ->
/// `<vehicle>/base_link`). Made only while somebody listens; nothing of the session is computed
/// from it.
#pragma once

#include <optional>

#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "nav_msgs/Odometry.h"
#include "ros/ros.h"
#include "tf2_msgs/TFMessage.h"

namespace cdiff::ros {

/// Pose in `map`, speed in the body frame.
nav_msgs::Odometry toOdometryMsg(const traffic::Vehicle& vehicle, double time);
/// Transforms of ego and CBVs.
tf2_msgs::TFMessage toTfMsg(const traffic::TrafficSnapshot& snapshot);
/// The same and, of each, base_link -> camera (x along the view, z up) -> camera_optical (x right,
/// y down, z along the view).
tf2_msgs::TFMessage toTfMsg(const traffic::TrafficSnapshot& snapshot,
                            const rendering::CameraOptions& camera);

class Display {
 public:
  explicit Display(::ros::NodeHandle& node);
  /// From now on tf holds the camera frames too.
  void showCameras(const rendering::CameraOptions& camera) { camera_ = camera; }
  void publish(const traffic::TrafficSnapshot& snapshot) const;

 private:
  ::ros::Publisher odometry_;
  ::ros::Publisher transforms_;
  std::optional<rendering::CameraOptions> camera_;
};

}  // namespace cdiff::ros
