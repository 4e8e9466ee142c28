"""Node recorder: keeps what happens on the topics, and writes it as one record when it is stopped."""

import math
import sys
import time
from functools import partial
from pathlib import Path
from typing import Any

from geometry_msgs.msg import AccelStamped, TwistStamped
from nav_msgs.msg import Odometry as OdometryMessage
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from tracked_interfaces.msg import GoalReached as GoalMessage
from tracked_interfaces.msg import SafetyState as SafetyMessage
from tracked_interfaces.msg import SlipEstimate as SlipMessage
from tracked_interfaces.msg import SolverStatus as StatusMessage
from tracked_interfaces.msg import Trajectory as TrajectoryMessage

from node_kit import Parameter, ParameterTable, StackNode, qos, run
from node_kit.conversions import (
    body_state_from_message,
    command_from_message,
    goal_reached_from_message,
    odometry_from_message,
    safety_state_from_message,
    slip_from_message,
    solver_status_from_message,
    tracks_from_message,
    trajectory_from_message,
    vertical_acceleration_from_message,
)
from tracked_bringup.odom_origin import OdomOrigin
from tracked_description import ROBOT_FILE, load_robot
from tracked_report.run_record import RunMeta
from tracked_report.run_recorder import RunRecorder
from tracked_types import ArbiterState, BodyState, GuardAction, Odometry

PARAMETERS = ParameterTable(
    Parameter("record_file", "record.npz", "file that the record is written to when the node is stopped"),
    Parameter("meta_file", "", "JSON file of what the record says of its run; empty: a record without origin"),
    qos.RELIABLE_SENSORS,
    Parameter(*ROBOT_FILE),
)
_DEPTH = 1000  # a record must not have holes where this process had to wait for a processor
_DRAIN_LIMIT_S = 5.0
_STATE = QoSProfile(depth=_DEPTH, reliability=ReliabilityPolicy.RELIABLE)


class RecorderNode(StackNode):
    """Subscribes the topics of `tracked_report.channels.CHANNELS`; publishes nothing but diagnostics."""

    NAME = "recorder"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        meta_file = self.value("meta_file")
        self.meta = (
            RunMeta.model_validate_json(Path(meta_file).read_text()) if meta_file else RunMeta(scenario="record")
        )
        self.record_file = Path(self.value("record_file"))
        self.recorder = RunRecorder()
        self.origin = OdomOrigin()
        self.safety_text = ""
        self.started_s = self.newest_s = math.nan
        radius_m = load_robot(self.value("robot_file")).tracks.wheel_radius_m
        tracks = partial(tracks_from_message, wheel_radius_m=radius_m)
        sensor = qos.sensor(reliable=self.value(qos.RELIABLE_SENSORS.name), depth=_DEPTH)
        self._keep(JointState, "joint_states", tracks, "tracks", sensor)
        self._keep(SlipMessage, "slip", slip_from_message, "slip")
        self._keep(SlipMessage, "ground_truth/slip", slip_from_message, "truth_slip")
        self._keep(TrajectoryMessage, "reference_trajectory", trajectory_from_message, "reference")
        self._keep(TrajectoryMessage, "upper_nmpc/trajectory", trajectory_from_message, "upper_plan")
        self._keep(TwistStamped, "cmd_vel_nav", command_from_message, "cmd_vel_nav", _STATE)
        self._keep(TwistStamped, "cmd_vel", command_from_message, "cmd_vel", _STATE)
        self._keep(StatusMessage, "upper_nmpc/status", solver_status_from_message, "upper_status")
        self._keep(StatusMessage, "lower_nmpc/status", solver_status_from_message, "lower_status")
        self._keep(GoalMessage, "goal_reached", goal_reached_from_message, "goal_reached", qos.LATCHED)
        self.subscribe_typed(OdometryMessage, "odom", odometry_from_message, self.on_odometry, _STATE)
        self.subscribe_typed(OdometryMessage, "ground_truth/odom", body_state_from_message, self.on_truth, _STATE)
        self.subscribe_typed(
            AccelStamped,
            "ground_truth/acceleration",
            vertical_acceleration_from_message,
            self.on_acceleration,
            _STATE,
        )
        self.subscribe_typed(SafetyMessage, "safety/state", safety_state_from_message, self.on_safety, qos.LATCHED)

    def on_odometry(self, odometry: Odometry) -> None:
        """The estimate."""
        self.origin.add_odometry(odometry)
        self._add("odometry", odometry)

    def on_truth(self, state: BodyState) -> None:
        """Pose and twist of the truth; its acceleration comes on a topic of its own."""
        self.origin.add_truth(state.stamp_ns, state.pose)
        self._add("truth", state)

    def on_acceleration(self, sample: tuple[int, float]) -> None:
        """True vertical acceleration."""
        stamp_ns, vertical_mps2 = sample
        self.recorder.add_row("acceleration", stamp_ns, (vertical_mps2,), arrival_s=time.monotonic())

    def on_safety(self, state: ArbiterState) -> None:
        """What the arbiter does is an event."""
        text = f"{state.mode.name.lower().replace('_', ' ')} {state.source}".rstrip()
        text += f": {state.reason}" if state.reason else ""
        text += f", {state.guard.value}" if state.guard not in (GuardAction.OFF, GuardAction.PASSING) else ""
        if text != self.safety_text:
            self.safety_text = text
            self.recorder.add_event(state.stamp_ns, "command_arbiter", text)

    def safe_stop(self) -> None:
        """Take in what has arrived and waits for its turn, then write the record."""
        self._drain()
        origin = self.origin.pose
        changes: dict[str, Any] = {}
        if origin is not None:
            changes["odom_in_world"] = (origin.x_m, origin.y_m, origin.yaw_rad)
        if math.isfinite(self.started_s):
            changes["wall_duration_s"] = self.newest_s - self.started_s
        record = self.recorder.record(self.meta.model_copy(update=changes))
        record.save(self.record_file)
        rows = sum(len(channel) for channel in record.channels.values())
        self.get_logger().info(f"{self.record_file}: {rows} rows in {len(record.channels)} channels")

    def _drain(self) -> None:
        """In lock-step the graph can be faster than this node: up to _DEPTH messages of a topic are waiting."""
        deadline_s = time.monotonic() + _DRAIN_LIMIT_S
        for typed in self.typed_subscriptions:
            subscription = typed.subscription
            while time.monotonic() < deadline_s:
                with subscription.handle:
                    taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
                if taken is None:
                    break
                subscription.callback(taken[0])

    def _keep(self, kind: type, topic: str, convert: Any, channel: str, profile: Any = _STATE) -> None:
        self.subscribe_typed(kind, topic, convert, partial(self._add, channel), profile)

    def _add(self, channel: str, value: Any) -> None:
        self.newest_s = time.monotonic()
        if math.isnan(self.started_s):
            self.started_s = self.newest_s
        self.recorder.add(channel, value, self.newest_s)


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(RecorderNode)


if __name__ == "__main__":
    sys.exit(main())
