"""A paced graph that drives in circles, one process per node: something to do harm to."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from tracked_interfaces.msg import SafetyState

from tests.support.graph_process import GraphProcess
from tests.support.listener import Listener, own_listener

START_LIMIT_S = 60.0  # where everything else runs at the same time
LOOK_EVERY_S = 0.02
DRIVING_MPS = 0.15
REST_MPS, REST_RADPS = 0.03, 0.1
ARGUMENTS = (
    "track",
    "time:=paced",
    "duration_s:=3600",
    "reference.shape:=circle",
    "reference.parameters:={radius_m: 0.8, speed_mps: 0.35}",
    "trajectory_player.loop:=true",
    "nodes.recorder:=false",
    "--grouping",
    "separate",
)


def stamp_ns(message: Any) -> int:
    """Stamp of a message with a header."""
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


class Driving:
    """The graph, and what can be seen of the robot in it."""

    def __init__(self, graph: GraphProcess, listener: Listener) -> None:
        self.graph = graph
        self.listener = listener
        self.truth = listener.hear(Odometry, "ground_truth/odom")
        self.odometry = listener.hear(Odometry, "odom")
        self.commands = listener.hear(TwistStamped, "cmd_vel")
        self.states = listener.hear(SafetyState, "safety/state", latched=True)

    @property
    def now_ns(self) -> int:
        """Newest simulated time seen."""
        return stamp_ns(self.truth[-1])

    def wait_until(self, condition: Callable[[], Any], what: str, timeout_s: float = START_LIMIT_S) -> None:
        """Look again and again until the condition holds.

        Raises:
            AssertionError: it did not hold in time, or the graph has ended.
        """
        deadline_s = time.monotonic() + timeout_s
        self.listener.refresh()
        while not condition():
            ended = self.graph.ends_within(LOOK_EVERY_S)
            assert not ended and time.monotonic() < deadline_s, f"in vain for {what}:\n{self.graph.output[-3000:]}"
            self.listener.refresh()

    def until_it_drives(self) -> None:
        """Wait until the robot is at speed, by fresh commands."""
        began_ns = self.now_ns if self.truth else 0
        self.wait_until(
            lambda: (
                self.truth
                and self.commands
                and self.truth[-1].twist.twist.linear.x > DRIVING_MPS
                and self.commands[-1].twist.linear.x > DRIVING_MPS
                and stamp_ns(self.commands[-1]) > began_ns
            ),
            "a driving robot",
        )

    def time_to_rest_s(self, since_ns: int) -> float:
        """Simulated time from ``since_ns`` until the robot has come to rest."""

        def at_rest() -> int | None:
            for message in reversed(self.truth):
                twist = message.twist.twist
                if stamp_ns(message) <= since_ns:
                    return None
                if abs(twist.linear.x) < REST_MPS and abs(twist.angular.z) < REST_RADPS:
                    return stamp_ns(message)
            return None

        self.wait_until(at_rest, "a robot at rest")
        rest_ns = at_rest()
        assert rest_ns is not None
        return (rest_ns - since_ns) * 1e-9


@contextmanager
def driving_graph(domain: int, folder: Path) -> Iterator[Driving]:
    """A graph that drives, ended with the block."""
    with own_listener(domain) as listener:
        graph = GraphProcess(domain, folder, *ARGUMENTS)
        try:
            yield Driving(graph, listener)
        finally:
            graph.end()
