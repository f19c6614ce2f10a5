// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Looks frames of the ego up while a session runs, as a user's node would, and writes to the file
// of its argument: how far base_link in `map` is from the snapshot of the same stamp, and whether
// the camera's optical axis (z) points along the vehicle's x axis, 6 degrees downwards: cos 6 =
// 0.9945.
#include <cmath>
#include <fstream>

#include "e2e_cdiff/TrafficSnapshot.h"
#include "ros/ros.h"
#include "tf2_ros/transform_listener.h"

namespace {

/// Direction of the z axis of a frame, along x: 2 (x z + w y).
double forwardOf(const geometry_msgs::Quaternion& q) { return 2.0 * (q.x * q.z + q.w * q.y); }

bool write(const tf2_ros::Buffer& frames, const e2e_cdiff::TrafficSnapshot& traffic,
           const std::string& file) {
  const e2e_cdiff::VehicleState& ego = traffic.vehicles.at(0).state;
  const auto base = frames.lookupTransform("map", "ego/base_link", traffic.header.stamp);
  const auto camera = frames.lookupTransform("ego/base_link", "ego/camera_optical", ros::Time(0));
  frames.lookupTransform("map", "ego/camera_optical",
                         traffic.header.stamp);  // throws without a chain
  const double forward = forwardOf(camera.transform.rotation);
  std::ofstream(file) << "base_link " << base.transform.translation.x - ego.x << " "
                      << base.transform.translation.y - ego.y << " "
                      << base.transform.translation.z - ego.z << "\ncamera_optical "
                      << (std::abs(forward - 0.9945) < 1e-3) << "\n";
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "frame_listener");
  if (argc < 2) return 3;
  ros::NodeHandle node;
  tf2_ros::Buffer frames;
  const tf2_ros::TransformListener listener(frames);
  e2e_cdiff::TrafficSnapshot::ConstPtr
      last;  // its transform has arrived when the next snapshot does
  bool written = false;
  const boost::function<void(const e2e_cdiff::TrafficSnapshot::ConstPtr&)> look =
      [&](const e2e_cdiff::TrafficSnapshot::ConstPtr& traffic) {
        try {
          if (!written && last && last->tick > 0) written = write(frames, *last, argv[1]);
        } catch (const tf2::TransformException& error) {
          ROS_INFO_THROTTLE(1.0, "%s", error.what());
        }
        last = traffic;
      };
  const ros::Subscriber input = node.subscribe<e2e_cdiff::TrafficSnapshot>("/traffic", 10, look);
  ros::spin();
}
