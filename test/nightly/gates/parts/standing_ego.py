#!/usr/bin/python3
"""An external ego that brakes fully at every decision."""
import rospy
from e2e_cdiff.msg import ControlAction, TrafficSnapshot


def on_traffic(snapshot, controls):
    if snapshot.status != TrafficSnapshot.RUNNING:
        rospy.signal_shutdown("the session is over")
    elif snapshot.decision_tick:
        controls.publish(ControlAction(tick=snapshot.tick, brake=1.0))


def main():
    rospy.init_node("standing_ego")
    controls = rospy.Publisher("ego/control", ControlAction, queue_size=10)
    rospy.Subscriber("traffic", TrafficSnapshot, on_traffic, controls, tcp_nodelay=True)
    rospy.spin()


if __name__ == "__main__":
    main()
