// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// An ego planner of the user's own: follows the session's route at 5 m/s. Start the session with
/// ego_planner:=external, then this node. All that the lockstep asks for is one ControlAction per
/// decision tick that carries the snapshot's tick.
#include <algorithm>
#include <cmath>

#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "nav_msgs/Path.h"
#include "ros/ros.h"

namespace {

e2e_cdiff::ControlAction drive(const e2e_cdiff::VehicleState& ego, const nav_msgs::Path& route) {
  // The first route point at least 6 m away and ahead (map frame, x forward and y left in the ego's
  // own).
  double angle = 0.0;
  for (const auto& pose : route.poses) {
    const double dx = pose.pose.position.x - ego.x;
    const double dy = pose.pose.position.y - ego.y;
    const double forward = std::cos(ego.heading) * dx + std::sin(ego.heading) * dy;
    const double left = -std::sin(ego.heading) * dx + std::cos(ego.heading) * dy;
    if (forward < 6.0 || std::hypot(forward, left) > 12.0) continue;
    angle = std::atan2(left, forward);
    break;
  }
  e2e_cdiff::ControlAction action;
  action.steer = std::clamp(2.0 * angle, -1.0, 1.0);
  action.throttle = ego.speed < 5.0 ? 0.5 : 0.0;
  action.brake = ego.speed > 6.0 ? 0.3 : 0.0;
  return action;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "external_ego_node");
  ros::NodeHandle node;
  nav_msgs::Path route;
  ros::Publisher controls = node.advertise<e2e_cdiff::ControlAction>("ego/control", 10);
  const boost::function<void(const nav_msgs::Path&)> on_route = [&](const nav_msgs::Path& path) {
    route = path;
  };
  const boost::function<void(const e2e_cdiff::TrafficSnapshot&)> on_traffic =
      [&](const e2e_cdiff::TrafficSnapshot& traffic) {
        if (traffic.status != e2e_cdiff::TrafficSnapshot::RUNNING)
          ros::requestShutdown();  // the session is over
        if (!traffic.decision_tick || traffic.vehicles.empty()) return;
        e2e_cdiff::ControlAction action =
            drive(traffic.vehicles.front().state, route);  // the ego comes first
        action.tick = traffic.tick;
        action.header.stamp = traffic.header.stamp;
        controls.publish(action);
      };
  const ros::Subscriber route_input = node.subscribe<nav_msgs::Path>("ego/route", 1, on_route);
  const auto at_once =
      ros::TransportHints().tcpNoDelay();  // else TCP holds small messages back for milliseconds
  const ros::Subscriber traffic_input =
      node.subscribe<e2e_cdiff::TrafficSnapshot>("traffic", 10, on_traffic, nullptr, at_once);
  ros::spin();
}
