#!/usr/bin/python3
"""Sends on a topic that is another node's: disturber.py TOPIC garbage|wrong SEED.

Whenever that node sends, `garbage` sends random bytes and `wrong` its message with other bytes in some places. Prints "waiting" before there
is such a topic, and "sent" once it has sent something.
"""
import random
import sys

import rospy
import rostopic

TOPIC, KIND, draw = sys.argv[1], sys.argv[2], random.Random(int(sys.argv[3]))


class Bytes:
    """A message of a topic's type whose content is any bytes."""

    def __init__(self, content):
        self.content = content

    def serialize(self, buffer):
        buffer.write(self.content)


def changed(content):
    content = bytearray(content)
    for _ in range(8):
        content[draw.randrange(len(content))] = draw.randrange(256)
    return bytes(content)


def main():
    rospy.init_node("disturber")
    print("waiting", flush=True)
    kind, name, _ = rostopic.get_topic_class(TOPIC, blocking=True)
    sent = type("Sent", (Bytes, kind), {"__slots__": ["content"], "_slot_types": ["uint8[]"], "_has_header": False})
    output = rospy.Publisher(name, sent, queue_size=10)

    def disturb(message):
        if message._connection_header["callerid"] == rospy.get_name():
            return
        output.publish(sent(draw.randbytes(draw.randrange(1, 2000)) if KIND == "garbage" else changed(message._buff)))
        print("sent", flush=True)

    rospy.Subscriber(name, rospy.AnyMsg, disturb)
    rospy.spin()


if __name__ == "__main__":
    main()
