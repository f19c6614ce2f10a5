#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
"""An ego by steering angle and speed. Start the session with ego_planner:=external set:=ego.command=ackermann."""
import math
import rospy
from e2e_cdiff.msg import AckermannCommand, TrafficSnapshot
from nav_msgs.msg import Path

WHEELBASE, LARGEST_ANGLE = 1.327, 0.368  # m, rad


def steering_angle(ego, route):
    """Pure pursuit of the first route point that lies ahead and 6 to 12 m away."""
    for place in (pose.pose.position for pose in route.poses):
        bearing = math.atan2(place.y - ego.y, place.x - ego.x) - ego.heading
        distance = math.hypot(place.x - ego.x, place.y - ego.y)
        if 6.0 <= distance <= 12.0 and math.cos(bearing) > 0.5:
            return max(-LARGEST_ANGLE, min(LARGEST_ANGLE, math.atan(WHEELBASE * 2.0 * math.sin(bearing) / distance)))
    return 0.0


def on_traffic(traffic):
    if traffic.status != TrafficSnapshot.RUNNING:
        rospy.signal_shutdown("the session is over")
    elif traffic.decision_tick and traffic.vehicles:
        angle = steering_angle(traffic.vehicles[0].state, route)  # the ego comes first
        commands.publish(AckermannCommand(tick=traffic.tick, steering_angle=angle, speed=5.0, acceleration=2.0))


rospy.init_node("ackermann_ego")
commands = rospy.Publisher("ego/ackermann", AckermannCommand, queue_size=10)
route = rospy.wait_for_message("ego/route", Path)
rospy.Subscriber("traffic", TrafficSnapshot, on_traffic, tcp_nodelay=True)  # else TCP holds small messages back
rospy.spin()
