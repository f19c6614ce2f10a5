#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
"""A CBV planner of the user's own in Python: every CBV follows its conflict-aware route and is at the conflict point when the ego is.
Start the session with cbv_planner:=external. Argument: max_cbv of the scenario (default 2)."""
import math
import rospy
from e2e_cdiff.msg import CbvSelection, ControlAction, TrafficSnapshot


def steer(state, route):
    """Toward the first route point that lies ahead and 6 to 12 m away."""
    for place in route:
        bearing = math.atan2(place.y - state.y, place.x - state.x) - state.heading
        if 6.0 <= math.hypot(place.x - state.x, place.y - state.y) <= 12.0 and math.cos(bearing) > 0.5:
            return max(-1.0, min(1.0, 2.0 * math.atan2(math.sin(bearing), math.cos(bearing))))
    return 0.0


def answer(traffic, selection):
    states = {vehicle.id: vehicle.state for vehicle in traffic.vehicles}
    for cbv in selection.assignments:  # one command for each occupied slot, for the vehicle in it
        if cbv.vehicle_id not in states:
            continue
        state = states[cbv.vehicle_id]
        wanted = min(13.0, cbv.cbv_distance / max(cbv.ego_arrival, 0.5)) if cbv.cbv_distance > 0.0 else 8.0
        controls[cbv.slot].publish(ControlAction(tick=traffic.tick, vehicle_id=cbv.vehicle_id, steer=steer(state, cbv.route_points),
                                                 throttle=0.6 if state.speed < wanted else 0.0, brake=0.3 if state.speed > wanted + 1.0 else 0.0))


def take(message):
    """Answers a decision once both of its messages are here; they come in any order."""
    if isinstance(message, TrafficSnapshot) and message.status != TrafficSnapshot.RUNNING:
        return rospy.signal_shutdown("the session is over")
    newest[type(message)] = message
    traffic, selection = newest.get(TrafficSnapshot), newest.get(CbvSelection)
    if traffic and selection and traffic.tick == selection.tick:
        answer(traffic, selection)


rospy.init_node("external_cbv")
newest = {}
slots = range(int((rospy.myargv()[1:] or ["2"])[0]))
controls = [rospy.Publisher(f"cbv_{slot}/control", ControlAction, queue_size=10) for slot in slots]
for topic, kind in (("cbv/selection", CbvSelection), ("traffic", TrafficSnapshot)):
    rospy.Subscriber(topic, kind, take, tcp_nodelay=True)  # else TCP holds small messages back
rospy.spin()
