"""The description node on its topics."""

import time
from xml.etree import ElementTree

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from node_kit import qos
from tracked_description.nodes.description import DescriptionNode
from tracked_types.checked_yaml import CheckedFileError

LIMIT_S = 10.0


@pytest.fixture
def started(monkeypatch):
    """``started(*arguments)`` makes the node as if the user had given the arguments, unseen by other processes."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")

    def start(*arguments):
        rclpy.init(args=["--ros-args", *arguments])
        return DescriptionNode()

    yield start
    rclpy.try_shutdown()


def latched(message_type, topic):
    """The message that a late subscriber gets."""
    received = []
    reader = rclpy.create_node("late_reader")
    reader.create_subscription(message_type, topic, received.append, qos.LATCHED)
    executor = SingleThreadedExecutor()
    executor.add_node(reader)
    deadline_s = time.monotonic() + LIMIT_S
    while not received:
        assert time.monotonic() < deadline_s, f"nothing on {topic}"
        executor.spin_once(timeout_sec=0.05)
    return received[0]


def test_late_subscriber_gets_urdf_and_frames_that_agree(started):
    started("-p", "frame_prefix:=robot1/", "-r", "__ns:=/robot1")
    root = ElementTree.fromstring(latched(String, "/robot1/robot_description").data)
    fixed = {
        (joint.find("parent").get("link"), joint.find("child").get("link"))
        for joint in root.iter("joint")
        if joint.get("type") == "fixed"
    }
    transforms = latched(TFMessage, "/robot1/tf_static").transforms
    assert {(each.header.frame_id, each.child_frame_id) for each in transforms} == fixed
    assert ("robot1/base_footprint", "robot1/base_link") in fixed


def test_robot_file_that_does_not_exist_is_named(started):
    with pytest.raises(CheckedFileError, match=r"/no/such/robot\.yaml: cannot be read"):
        started("-p", "robot_file:=/no/such/robot.yaml")
