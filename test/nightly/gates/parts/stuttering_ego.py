#!/usr/bin/python3
"""An external ego that falls silent again and again: stuttering_ego.py SPOKEN SILENT LOG.

It answers decisions for about SPOKEN simulated seconds with half of full braking, and none for SILENT. LOG gets the last tick answered
before each silence.
"""
import random
import sys

import rospy
from e2e_cdiff.msg import ControlAction, TrafficSnapshot

SPOKEN, SILENT, LOG = float(sys.argv[1]), float(sys.argv[2]), open(sys.argv[3], "w", buffering=1)
draw = random.Random(1)


class Ego:
    def __init__(self):
        self.controls = rospy.Publisher("ego/control", ControlAction, queue_size=10)
        self.answered, self.silence_at, self.back_at = None, draw.uniform(1.0, 2.0) * SPOKEN, 0.0
        rospy.Subscriber("traffic", TrafficSnapshot, self.on_traffic, tcp_nodelay=True)

    def on_traffic(self, snapshot):
        if snapshot.status != TrafficSnapshot.RUNNING:
            rospy.signal_shutdown("the session is over")
        elif snapshot.time >= self.silence_at:
            print(self.answered, file=LOG)
            self.back_at = snapshot.time + SILENT
            self.silence_at = self.back_at + draw.uniform(0.5, 1.5) * SPOKEN
        elif snapshot.decision_tick and snapshot.time >= self.back_at:
            self.controls.publish(ControlAction(tick=snapshot.tick, brake=0.5))
            self.answered = snapshot.tick


rospy.init_node("stuttering_ego")
ego = Ego()
rospy.spin()
