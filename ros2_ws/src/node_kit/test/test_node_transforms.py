"""Transforms of nodes of one graph: sent, heard, malformed, and after a jump of the clock."""

import math

import pytest
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

from node_kit import RigidTransform, StackNode, TransformListener
from node_kit.conversions import clock_to_message


class Traveller(StackNode):
    """Sends one moving and two static transforms."""

    NAME = "traveller"

    def travel(self, x, stamp_ns):
        self.transforms.send(self.frame("odom"), self.frame("base"), x, 0.0, 0.0, 0.0, 0.0, 0.0, stamp_ns)

    def stand(self):
        self.transforms.send_static(self.frame("base"), self.frame("laser"), 0.1, 0.0, 0.2, 0.0, 0.0, 0.0)
        self.transforms.send_static(self.frame("base"), self.frame("imu"), 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


class Watcher(StackNode):
    """Listens to transforms."""

    NAME = "watcher"

    def __init__(self, **options) -> None:
        super().__init__(**options)
        self.listener = TransformListener(self)


def known(buffer, *query):
    try:
        return buffer.lookup(*query)
    except LookupError:
        return None


def test_two_robots_in_two_namespaces_keep_apart(graph):
    robots = {}
    for name, x in (("robot1", 1.0), ("robot2", 2.0)):
        arguments = ("-r", f"__ns:=/{name}", "-p", f"frame_prefix:={name}/")
        robots[name] = traveller, watcher = graph.add(Traveller, *arguments), graph.add(Watcher, *arguments)
        traveller.stand()
        traveller.travel(x, 5)
        graph.spin_until(
            lambda watcher=watcher, name=name: known(watcher.listener.buffer, f"{name}/base", f"{name}/imu"),
            "static transforms",
        )
    for name, x in (("robot1", 1.0), ("robot2", 2.0)):
        traveller, watcher = robots[name]

        def arrived(traveller=traveller, watcher=watcher, name=name, x=x):
            traveller.travel(x, 5)
            return known(watcher.listener.buffer, f"{name}/odom", f"{name}/laser", 5)

        assert graph.spin_until(arrived, "a moving transform").translation_m[0] == pytest.approx(x + 0.1)
        other = "robot2" if name == "robot1" else "robot1"
        assert known(watcher.listener.buffer, f"{other}/base", f"{other}/imu") is None


def test_late_listener_gets_all_static_transforms(graph):
    graph.add(Traveller).stand()
    watcher = graph.add(Watcher)
    graph.spin_until(lambda: known(watcher.listener.buffer, "laser", "imu"), "static transforms")


def test_malformed_transform_is_rejected(graph):
    watcher = graph.add(Watcher)
    newest = graph.statuses()
    publisher = graph.plain("liar").create_publisher(TFMessage, "tf", 10)
    graph.spin_until(publisher.get_subscription_count, "the listener")
    traveller = graph.add(Traveller)
    traveller.travel(math.nan, 5)
    graph.spin_until(lambda: "watcher: inputs" in newest, "a report")
    assert "not finite: translation.x" in newest["watcher: inputs"].message
    assert known(watcher.listener.buffer, "odom", "base") is None


def test_listener_forgets_motion_when_simulated_time_jumps_back(graph):
    watcher = graph.add(Watcher, "-p", "use_sim_time:=true")
    watcher.listener.buffer.add_static("base", "laser", RigidTransform.identity())
    watcher.listener.buffer.add("odom", "base", RigidTransform.identity(), 100 * 10**9)
    publisher = graph.plain("simulator").create_publisher(Clock, "/clock", 10)
    graph.spin_until(publisher.get_subscription_count, "the watcher's clock")
    for seconds in (100, 1):
        publisher.publish(clock_to_message(seconds * 10**9))
        graph.spin_until(lambda s=seconds: watcher.get_clock().now().nanoseconds == s * 10**9, "the time")
    assert known(watcher.listener.buffer, "odom", "base") is None
    assert known(watcher.listener.buffer, "base", "laser") is not None
