"""What both teleoperation nodes do with the twist that is asked for."""

import time
from collections.abc import Callable
from functools import partial

from geometry_msgs.msg import TwistStamped

from node_kit import StackNode, qos
from node_kit.conversions import command_to_message
from tracked_description import Robot
from tracked_types import StampOrder, Twist2, VelocityCommand


class TeleopOutput:
    """Publishes cmd_vel_teleop once per control period, stamped with the node's time, as long as anything is asked."""

    def __init__(self, node: StackNode, robot: Robot, twist_at: Callable[[float], Twist2 | None]) -> None:
        self._clock = node.get_clock()
        self._twist_at = twist_at
        self._order = StampOrder()
        to_message = partial(command_to_message, frame_id=node.frame(robot.frames.base_footprint))
        self._commands = node.publish_typed(TwistStamped, "cmd_vel_teleop", to_message, qos.COMMAND)

    def publish(self) -> None:
        """Send what is asked for, if anything is, and if time has gone on."""
        twist = self._twist_at(time.monotonic())
        if twist is not None:
            self._send(twist)

    def stop(self) -> None:
        """Rest, if anything is asked for, as the last word."""
        if self._twist_at(time.monotonic()) is not None:
            self._send(Twist2(0.0, 0.0))

    def _send(self, twist: Twist2) -> None:
        stamp_ns = self._clock.now().nanoseconds
        # Simulated time is zero until it is known, and may stand still.
        if stamp_ns > 0 and self._order.advance(stamp_ns):
            self._commands.publish(VelocityCommand(stamp_ns, twist))
