"""The description node as others see it: one latched URDF, one latched set of frames, and one line for a bad file."""

import xml.etree.ElementTree as ElementTree

from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

NODE = ("tracked_description", "description")
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_a_late_subscriber_still_gets_the_robot(probe, start_node):
    start_node(*NODE)
    probe.wait_until(lambda: "description" in probe.node.get_node_names(), what="the node")
    described = probe.collect(String, "robot_description", LATCHED)
    frames = probe.collect(TFMessage, "tf_static", LATCHED)
    probe.wait_until(lambda: described and frames, what="the URDF and the fixed frames")
    robot = ElementTree.fromstring(described[0].data)
    links = {link.attrib["name"] for link in robot.iter("link")}
    for transform in frames[0].transforms:
        assert {transform.header.frame_id, transform.child_frame_id} <= links


def test_a_robot_file_that_does_not_exist_is_one_clear_line(start_node):
    node = start_node(*NODE, "--ros-args", "-p", "robot_file:=/no/such/robot.yaml")
    assert node.wait() == 1
    assert "/no/such/robot.yaml" in node.output
    assert "Traceback" not in node.output
