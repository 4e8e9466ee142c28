"""Node upper_nmpc: plans along the reference at 5 Hz; with `layers: single` it also commands the base."""

import sys
from functools import partial

from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry as OdometryMessage
from tracked_interfaces.msg import SlipEstimate as SlipMessage
from tracked_interfaces.msg import SolverStatus as SolverStatusMessage
from tracked_interfaces.msg import Trajectory as TrajectoryMessage

from nmpc_layers import UpperLayer, UpperSettings
from nmpc_layers.nodes.status_report import StatusReport
from nmpc_layers.odometry_queue import OdometryQueue
from node_kit import Parameter, ParameterTable, StackNode, qos, run
from node_kit.conversions import (
    command_from_message,
    command_to_message,
    odometry_from_message,
    slip_from_message,
    solver_status_to_message,
    trajectory_from_message,
    trajectory_to_message,
)
from tracked_description import ROBOT_FILE, load_robot
from tracked_types import Odometry, Slip, VelocityCommand

PARAMETERS = ParameterTable.from_settings(
    UpperSettings,
    extra=(
        Parameter("lock_step", False, "withhold each plan until slip and the word on the last command have arrived"),
        Parameter(*ROBOT_FILE),
    ),
)


class UpperNmpcNode(StackNode):
    """Subscribes odom, slip, reference_trajectory, cmd_vel; publishes trajectory and status, alone also cmd_vel_nav."""

    NAME = "upper_nmpc"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        self.layer = UpperLayer(UpperSettings.from_robot(robot, **self.tuning(UpperSettings)))
        self.lock_step = self.value("lock_step")
        self.trajectory = self.publish_typed(
            TrajectoryMessage, "upper_nmpc/trajectory", trajectory_to_message, qos.STATE
        )
        self.status = self.publish_typed(SolverStatusMessage, "upper_nmpc/status", solver_status_to_message, qos.STATE)
        self.command = None
        if self.layer.settings.layers == "single":
            stamped = partial(command_to_message, frame_id=self.frame(robot.frames.base_footprint))
            self.command = self.publish_typed(TwistStamped, "cmd_vel_nav", stamped, qos.COMMAND)
        self.report = StatusReport(self, self.layer.solver.interpreter_reason)
        self.odometry = OdometryQueue(self.must_wait, self.tick, self.report.note_overdue)
        odom_frame = self.frame(robot.frames.odom)
        self.subscribe_typed(
            TrajectoryMessage,
            "reference_trajectory",
            trajectory_from_message,
            self.layer.set_reference,
            qos.STATE,
            expected_frame=odom_frame,
        )
        base_frame = self.frame(robot.frames.base_footprint)
        self.subscribe_typed(SlipMessage, "slip", slip_from_message, self.on_slip, qos.STATE, expected_frame=base_frame)
        self.subscribe_typed(TwistStamped, "cmd_vel", command_from_message, self.on_sent, qos.COMMAND)
        self.subscribe_typed(
            OdometryMessage, "odom", odometry_from_message, self.odometry.add, qos.STATE, expected_frame=odom_frame
        )

    def on_slip(self, slip: Slip) -> None:
        """The slip estimate; in lock-step a plan may have waited for it."""
        self.layer.set_slip(slip)
        self.odometry.work_off()

    def on_sent(self, command: VelocityCommand) -> None:
        """Word of what was sent; in lock-step a plan may have waited for it."""
        self.layer.set_sent(command)
        self.odometry.work_off()

    def must_wait(self, stamp_ns: int) -> bool:
        """Whether the tick of a stamp lacks what lock-step promises it."""
        return self.lock_step and (self.layer.waits_for_sent(stamp_ns) or self.layer.waits_for_slip(stamp_ns))

    def tick(self, odometry: Odometry) -> None:
        """Publish what one odometry brings about."""
        output = self.layer.update(odometry)
        if output is None:
            return
        if output.trajectory is not None:
            self.trajectory.publish(output.trajectory)
        if output.command is not None and self.command is not None:
            self.command.publish(output.command)
        if output.status is not None:
            self.status.publish(output.status)
            self.report.note(
                output.status,
                goal=self.layer.approach.phase.value,
                ignored_odometry=self.layer.ignored_odometry,
            )


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(UpperNmpcNode)


if __name__ == "__main__":
    sys.exit(main())
