"""Node command_arbiter: the only publisher of cmd_vel."""

import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Any

from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import LaserScan as LaserScanMessage
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
    scan_from_message,
    twist_to_message,
)
from tracked_description import ROBOT_FILE, load_robot
from tracked_safety import (
    SOURCES,
    ArbiterSettings,
    CollisionGuard,
    CommandArbiter,
    CommandRefused,
    GuardSettings,
    ScanRefused,
)
from tracked_types import ArbiterMode, GuardAction, LaserScan, Odometry, VelocityCommand

COLLISION_GUARD = Parameter(
    "collision_guard",
    True,
    "judge every command by `scan`, and stand still without one; false: for a robot without a lidar",
)
PARAMETERS = ParameterTable.from_settings(
    ArbiterSettings,
    GuardSettings,
    extra=(
        COLLISION_GUARD,
        qos.RELIABLE_SENSORS,
        Parameter(
            "plain_twist", False, "cmd_vel is a geometry_msgs/Twist, and cmd_vel_stamped what is sent, with stamps"
        ),
        Parameter(
            "lock_step",
            False,
            "simulated time waits for commands: wall-clock silence does not stop the robot, and a command waits for "
            "the odometry and the scan that it is judged by",
        ),
        Parameter(*ROBOT_FILE),
    ),
)


class CommandArbiterNode(StackNode):
    """Subscribes one cmd_vel_* and one lock_* topic per source, e_stop, odom, scan; publishes cmd_vel, safety/state."""

    NAME = "command_arbiter"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        self._lock_step = self.value("lock_step")
        self.guard: CollisionGuard | None = None
        if self.value(COLLISION_GUARD.name):
            self.guard = CollisionGuard(GuardSettings.from_robot(robot, **self.tuning(GuardSettings)))
        settings = ArbiterSettings.from_robot(robot, **self.tuning(ArbiterSettings))
        self.arbiter = CommandArbiter(settings, self.guard, lock_step=self._lock_step)
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
            self._subscribe_switch(f"lock_{source}", partial(self.on_lock, source))
        odom_frame = self.frame(robot.frames.odom)
        self._subscribe_switch("e_stop", self.on_e_stop)
        self.subscribe_typed(
            OdometryMessage, "odom", odometry_from_message, self.on_odometry, qos.STATE, expected_frame=odom_frame
        )
        sensor = qos.sensor(reliable=self.value(qos.RELIABLE_SENSORS.name))
        lidar_frame = self.frame(robot.frames.lidar)
        self.subscribe_typed(
            LaserScanMessage, "scan", scan_from_message, self.on_scan, sensor, expected_frame=lidar_frame
        )
        self.serve(Trigger, "e_stop", self.on_press)
        self.serve(Trigger, "release_e_stop", self.on_release)
        self._timeout_s = settings.timeout_s
        self._control_period_s = 1.0 / settings.rate_hz
        self._heard_s = time.monotonic()
        self._published: tuple[ArbiterMode, str, GuardAction] | None = None
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
        self._send(self.arbiter.add_odometry(odometry))

    def on_scan(self, scan: LaserScan) -> None:
        """What the guard, if there is one, sees; node_kit counts scans that it refuses."""
        try:
            self._send(self.arbiter.add_scan(scan))
        except ScanRefused as refusal:
            raise RejectedMessage(refusal.reason) from refusal

    def on_lock(self, source: str, locked: bool) -> None:
        """Keeps a source and those below it from passing."""
        self.arbiter.set_lock(source, locked)
        self._report()

    def on_e_stop(self, asserted: bool) -> None:
        """The signal latches here."""
        self.arbiter.set_e_stop(asserted)
        self._report()

    def on_press(self, _request: Any, response: Any) -> Any:
        """The same as the signal, for somebody who does not keep it up."""
        self.arbiter.press_e_stop()
        response.success, response.message = True, "stopped until release_e_stop"
        self._report()
        return response

    def on_release(self, _request: Any, response: Any) -> Any:
        """Ends a latched stop, unless its cause is still there."""
        refusal = self.arbiter.release()
        response.success, response.message = refusal is None, refusal or "released"
        self._report()
        return response

    def on_wall_clock(self) -> None:
        """When stamps stop coming, the wall clock is all that is left."""
        if time.monotonic() - self._heard_s <= self._timeout_s:
            return
        if not self._lock_step:
            self._send(self.arbiter.lost_time())
        elif self.arbiter.is_waiting:
            self._send(self.arbiter.stop_waiting())

    def safe_stop(self) -> None:
        """Ramp to zero before leaving; at most the time that braking takes."""
        for command in self.arbiter.stop("shutting down"):
            self._send(command)
            time.sleep(self._control_period_s)

    def _subscribe_switch(self, topic: str, callback: Callable[[bool], None]) -> None:
        """Hear who publishes a switch latched, whenever that was, and who does not, as the command line."""
        for durability in (qos.LATCHED, qos.STATE):
            self.subscribe_typed(Bool, topic, bool_from_message, callback, durability)

    def _send(self, command: VelocityCommand | None) -> None:
        if command is not None:
            self.stamped.publish(command)
            if self.plain is not None:
                self.plain.publish(command.twist)
        self._report()

    def _report(self, force: bool = False) -> None:
        state = self.arbiter.state
        seen = (state.mode, state.reason, state.guard)
        if not force and seen == self._published:
            return
        self._published = seen
        self.state.publish(state)
        values = {f"limited: {source}": count for source, count in self.arbiter.cut_off.items()}
        stopped = state.mode not in (ArbiterMode.FORWARDING, ArbiterMode.IDLE)
        message = f"{state.mode.value}: {state.reason}" if state.reason else state.mode.value
        self.diagnostics.report("commands", Level.WARN if stopped else Level.OK, message, values)
        if self.guard is not None:
            limits = state.guard is not GuardAction.PASSING
            message = f"{state.guard.value}: {state.guard_reason}" if limits else state.guard.value
            level = Level.WARN if limits else Level.OK
            self.diagnostics.report("collision guard", level, message, {"way to contact (m)": state.obstacle_m})


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(CommandArbiterNode)


if __name__ == "__main__":
    sys.exit(main())
