"""The description node as others see it: one latched URDF, one latched set of frames, and a polite end."""

import signal
import xml.etree.ElementTree as ElementTree

import pytest
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


def test_two_robots_live_in_two_namespaces_with_their_own_frames(probe, start_node):
    for name in ("left", "right"):
        start_node(*NODE, "--ros-args", "-r", f"__ns:=/{name}", "-p", f"frame_prefix:={name}/")
    frames = {name: probe.collect(TFMessage, f"/{name}/tf_static", LATCHED) for name in ("left", "right")}
    probe.wait_until(lambda: all(frames.values()), what="the frames of both")
    for name, messages in frames.items():
        seen = {transform.child_frame_id for message in messages for transform in message.transforms}
        assert seen
        assert all(frame.startswith(f"{name}/") for frame in seen)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_with_exit_code_0(probe, start_node, number):
    node = start_node(*NODE)
    probe.wait_until(lambda: "description" in probe.node.get_node_names(), what="the node")
    assert node.stop(number) == 0
    assert "Traceback" not in node.output


def test_a_robot_file_that_does_not_exist_is_one_clear_line(start_node):
    node = start_node(*NODE, "--ros-args", "-p", "robot_file:=/no/such/robot.yaml")
    assert node.wait() == 1
    assert "/no/such/robot.yaml" in node.output
    assert "Traceback" not in node.output


def test_a_parameter_of_the_wrong_type_is_refused(start_node):
    node = start_node(*NODE, "--ros-args", "-p", "robot_file:=3")
    assert node.wait() == 2
    assert "robot_file" in node.output
    assert "Traceback" not in node.output
