// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/display.h"

#include <cmath>

#include "e2e_cdiff/ros/conversions.h"
#include "e2e_cdiff/ros/topics.h"

namespace cdiff::ros {
namespace {

geometry_msgs::Quaternion toQuaternion(double heading) {
  geometry_msgs::Quaternion quaternion;
  quaternion.z = std::sin(0.5 * heading);
  quaternion.w = std::cos(0.5 * heading);
  return quaternion;
}

std::string frameOf(const traffic::Vehicle& vehicle) { return vehicle.id + "/base_link"; }

}  // namespace

nav_msgs::Odometry toOdometryMsg(const traffic::Vehicle& vehicle, double time) {
  nav_msgs::Odometry message;
  message.header.stamp = toStamp(time);
  message.header.frame_id = kMapFrame;
  message.child_frame_id = frameOf(vehicle);
  message.pose.pose.position.x = vehicle.state.position.x();
  message.pose.pose.position.y = vehicle.state.position.y();
  message.pose.pose.position.z = vehicle.state.elevation;
  message.pose.pose.orientation = toQuaternion(vehicle.state.heading);
  message.twist.twist.linear.x = vehicle.state.speed;
  message.twist.twist.angular.z = vehicle.yaw_rate;
  return message;
}

tf2_msgs::TFMessage toTfMsg(const traffic::TrafficSnapshot& snapshot) {
  tf2_msgs::TFMessage message;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) continue;
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = toStamp(snapshot.time);
    transform.header.frame_id = kMapFrame;
    transform.child_frame_id = frameOf(vehicle);
    transform.transform.translation.x = vehicle.state.position.x();
    transform.transform.translation.y = vehicle.state.position.y();
    transform.transform.translation.z = vehicle.state.elevation;
    transform.transform.rotation = toQuaternion(vehicle.state.heading);
    message.transforms.push_back(transform);
  }
  return message;
}

Display::Display(::ros::NodeHandle& node)
    : odometry_(node.advertise<nav_msgs::Odometry>(kEgoOdometryTopic, 100)),
      transforms_(node.advertise<tf2_msgs::TFMessage>("/tf", 100)) {}

void Display::publish(const traffic::TrafficSnapshot& snapshot) const {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego != nullptr && odometry_.getNumSubscribers() > 0)
    odometry_.publish(toOdometryMsg(*ego, snapshot.time));
  if (transforms_.getNumSubscribers() > 0) transforms_.publish(toTfMsg(snapshot));
}

}  // namespace cdiff::ros
