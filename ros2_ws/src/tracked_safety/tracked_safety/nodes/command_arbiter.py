"""Node command_arbiter: the only publisher of cmd_vel."""

import sys
import time
from functools import partial
from typing import Any

from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry as OdometryMessage
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from tracked_interfaces.msg import SafetyState

from node_kit import Level, Parameter, ParameterTable, RejectedMessage, StackNode, qos, run
from node_kit.conversions import (
    bool_from_message,
    command_from_message,
    command_to_message,
    odometry_from_message,
    safety_state_to_message,
    twist_to_message,
)
from tracked_description import ROBOT_FILE, load_robot
from tracked_safety import SOURCES, ArbiterSettings, CommandArbiter, CommandRefused
from tracked_types import ArbiterMode, Odometry, VelocityCommand

PARAMETERS = ParameterTable.from_settings(
    ArbiterSettings,
    extra=(
        Parameter(
            "plain_twist", False, "cmd_vel is a geometry_msgs/Twist, and cmd_vel_stamped what is sent, with stamps"
        ),
        Parameter(
            "lock_step", False, "simulated time waits for commands, so wall-clock silence does not stop the robot"
        ),
        Parameter(*ROBOT_FILE),
    ),
)


class CommandArbiterNode(StackNode):
    """Subscribes one cmd_vel_* topic per source, e_stop and odom; publishes cmd_vel and safety/state."""

    NAME = "command_arbiter"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        self.arbiter = CommandArbiter(ArbiterSettings.from_robot(robot, **self.tuning(ArbiterSettings)))
        stamped = partial(command_to_message, frame_id=self.frame(robot.frames.base_footprint))
        plain_twist = self.value("plain_twist")
        self.stamped = self.publish_typed(
            TwistStamped, "cmd_vel_stamped" if plain_twist else "cmd_vel", stamped, qos.COMMAND
        )
        self.plain = self.publish_typed(Twist, "cmd_vel", twist_to_message, qos.COMMAND) if plain_twist else None
        self.state = self.publish_typed(SafetyState, "safety/state", safety_state_to_message, qos.LATCHED)
        for source in SOURCES:
            self.subscribe_typed(
                TwistStamped, f"cmd_vel_{source}", command_from_message, partial(self.on_command, source), qos.COMMAND
            )
        odom_frame = self.frame(robot.frames.odom)
        self.subscribe_typed(Bool, "e_stop", bool_from_message, self.on_e_stop, qos.LATCHED)
        self.subscribe_typed(
            OdometryMessage, "odom", odometry_from_message, self.on_odometry, qos.STATE, expected_frame=odom_frame
        )
        self.serve(Trigger, "release_e_stop", self.on_release)
        self._timeout_s = self.arbiter.settings.timeout_s
        self._control_period_s = 1.0 / self.arbiter.settings.rate_hz
        self._lock_step = self.value("lock_step")
        self._heard_s = time.monotonic()
        self._published_mode: ArbiterMode | None = None
        self.every_wall(self._control_period_s, self.on_wall_clock)
        self.every_wall(1.0, partial(self._report, force=True))

    def on_command(self, source: str, command: VelocityCommand) -> None:
        """One command in; the same callback sends what may pass. node_kit counts refusals with their sender."""
        try:
            sent = self.arbiter.offer(source, command)
        except CommandRefused as refusal:
            raise RejectedMessage(refusal.reason) from refusal
        if sent is not None:
            self._heard_s = time.monotonic()
        self._send(sent)

    def on_odometry(self, odometry: Odometry) -> None:
        """Odometry is the clock of the watchdog."""
        self._heard_s = time.monotonic()
        self._send(self.arbiter.tick(odometry.stamp_ns))

    def on_e_stop(self, asserted: bool) -> None:
        """The signal latches here."""
        self.arbiter.set_e_stop(asserted)
        self._report()

    def on_release(self, _request: Any, response: Any) -> Any:
        """Ends an emergency stop, unless it is still pressed."""
        refusal = self.arbiter.release()
        response.success, response.message = refusal is None, refusal or "released"
        self._report()
        return response

    def on_wall_clock(self) -> None:
        """When stamps stop coming, the wall clock is all that is left."""
        if not self._lock_step and time.monotonic() - self._heard_s > self._timeout_s:
            self._send(self.arbiter.lost_time())

    def safe_stop(self) -> None:
        """Ramp to zero before leaving; at most the time that braking takes."""
        for command in self.arbiter.stop("shutting down"):
            self._send(command)
            time.sleep(self._control_period_s)

    def _send(self, command: VelocityCommand | None) -> None:
        if command is not None:
            self.stamped.publish(command)
            if self.plain is not None:
                self.plain.publish(command.twist)
        self._report()

    def _report(self, force: bool = False) -> None:
        state = self.arbiter.state
        if not force and state.mode is self._published_mode:
            return
        self._published_mode = state.mode
        self.state.publish(state)
        values = {f"limited: {source}": count for source, count in self.arbiter.cut_off.items()}
        stopped = state.mode in (ArbiterMode.STOPPING, ArbiterMode.STOPPED, ArbiterMode.EMERGENCY_STOP)
        message = f"{state.mode.value}: {state.reason}" if state.reason else state.mode.value
        self.diagnostics.report("commands", Level.WARN if stopped else Level.OK, message, values)


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(CommandArbiterNode)


if __name__ == "__main__":
    sys.exit(main())
