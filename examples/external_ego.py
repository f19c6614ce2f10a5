#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
"""An ego planner of the user's own in Python: follows the session's route at 5 m/s. Start the session with ego_planner:=external."""
import math
import rospy
from e2e_cdiff.msg import ControlAction, TrafficSnapshot
from nav_msgs.msg import Path


def steer(ego, route):
    """Toward the first route point that lies ahead and 6 to 12 m away."""
    for place in (pose.pose.position for pose in route.poses):
        bearing = math.atan2(place.y - ego.y, place.x - ego.x) - ego.heading
        if 6.0 <= math.hypot(place.x - ego.x, place.y - ego.y) <= 12.0 and math.cos(bearing) > 0.5:
            return max(-1.0, min(1.0, 2.0 * math.atan2(math.sin(bearing), math.cos(bearing))))
    return 0.0


def on_traffic(traffic):
    if traffic.status != TrafficSnapshot.RUNNING:
        rospy.signal_shutdown("the session is over")
    elif traffic.decision_tick and traffic.vehicles:
        ego = traffic.vehicles[0].state  # the ego comes first
        controls.publish(ControlAction(tick=traffic.tick, steer=steer(ego, route), throttle=0.5 if ego.speed < 5.0 else 0.0,
                                       brake=0.3 if ego.speed > 6.0 else 0.0))


rospy.init_node("external_ego")
controls = rospy.Publisher("ego/control", ControlAction, queue_size=10)
route = rospy.wait_for_message("ego/route", Path)
rospy.Subscriber("traffic", TrafficSnapshot, on_traffic, tcp_nodelay=True)  # else TCP holds small messages back
rospy.spin()
