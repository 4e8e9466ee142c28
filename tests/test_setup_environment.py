"""The environment that the set-up makes: messages, discovery, the starter."""

import subprocess

from geometry_msgs.msg import Twist
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from tracked_interfaces.msg import SlipEstimate

from tests.support.node_process import ROOT
from tests.support.probe import own_probe

TALKER = """
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("talker")
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_publisher(String, "words", latched).publish(String(data="hello"))
try:
    rclpy.spin(node)
except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
    pass
"""


def test_two_processes_talk_over_dds(probe, start_node):
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    words = probe.collect(String, "words", latched)
    start_node("python", "-c", TALKER)
    probe.wait_until(lambda: words, what="a word")
    assert words[0].data == "hello"


def test_another_domain_hears_nothing(probe, ros_domain, start_node):
    start_node("python", "-c", TALKER)
    probe.wait_until(lambda: "talker" in probe.node.get_node_names(), what="the talker")
    with own_probe(ros_domain + 1) as stranger:
        assert "talker" not in stranger.node.get_node_names()


def test_own_and_tf_messages_have_type_support(probe):
    for message_type, topic in ((TFMessage, "tf"), (SlipEstimate, "slip")):
        received = probe.collect(message_type, topic)
        publisher = probe.publisher(message_type, topic)
        publisher.publish(message_type())
        probe.wait_until(lambda received=received: received, what=topic)


def test_wrong_field_types_are_errors_under_test():
    message = Twist()
    try:
        message.linear.x = 1
    except AssertionError:
        return
    raise AssertionError("an int in a float field would be sent as garbage")


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(ROOT / "run"), *arguments], capture_output=True, text=True, check=False, timeout=60)


def test_the_starter_names_the_packages_when_one_is_unknown():
    done = run("no_such_package", "node")
    assert done.returncode == 1
    assert "Package 'no_such_package' not found" in done.stderr
    assert "sim_bridge" in done.stderr


def test_the_starter_names_the_executables_when_one_is_unknown():
    done = run("sim_bridge", "no_such_node")
    assert done.returncode == 1
    assert "No executable 'no_such_node' in package 'sim_bridge'" in done.stderr
    assert "sim_bridge sim_bridge" in done.stderr


def test_the_starter_hands_down_the_exit_code():
    assert run("python", "-c", "raise SystemExit(7)").returncode == 7


def test_the_starter_explains_itself():
    done = run("--help")
    assert done.returncode == 0
    assert "./run PACKAGE EXECUTABLE" in done.stdout
    assert run().stdout == done.stdout
