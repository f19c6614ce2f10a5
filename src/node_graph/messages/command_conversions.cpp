// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/command_conversions.h"

#include <string>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {
namespace {

void requireZero(double value, const char* name) {
  if (value == 0.0) return;
  throw core::InputError(std::string(name) + " is " + core::formatNumber(value) +
                         "; expected 0, the vehicle drives along its heading in the plane");
}

}  // namespace

planning::AckermannCommand fromMsg(const msgs::AckermannCommand& message) {
  if (message.drive_by > msgs::AckermannCommand::ACCELERATION) {
    throw core::InputError("drive_by is " + std::to_string(message.drive_by) +
                           "; expected SPEED (0) or ACCELERATION (1)");
  }
  planning::AckermannCommand command;
  command.steering_angle = message.steering_angle;
  command.steering_angle_velocity = message.steering_angle_velocity;
  command.by_acceleration = message.drive_by == msgs::AckermannCommand::ACCELERATION;
  command.speed = message.speed;
  command.acceleration = message.acceleration;
  command.jerk = message.jerk;
  return command;
}

planning::VelocityCommand fromMsg(const geometry_msgs::Twist& message) {
  requireZero(message.linear.y, "linear.y");
  requireZero(message.linear.z, "linear.z");
  requireZero(message.angular.x, "angular.x");
  requireZero(message.angular.y, "angular.y");
  return {message.linear.x, message.angular.z};
}

std::vector<planning::TimedPlace> trajectoryFrom(const nav_msgs::Path& message) {
  if (message.header.frame_id != frameId(kMapFrame)) {
    throw core::InputError("the trajectory's frame is '" + message.header.frame_id +
                           "'; expected '" + frameId(kMapFrame) + "'");
  }
  std::vector<planning::TimedPlace> places;
  for (const geometry_msgs::PoseStamped& pose : message.poses)
    places.push_back({pose.header.stamp.toSec(), {pose.pose.position.x, pose.pose.position.y}});
  return places;
}

}  // namespace cdiff::node_graph
