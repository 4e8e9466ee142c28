"""A controller that steers along the newest reference at the control rate."""

import time
from typing import Any, Protocol

import numpy as np

from nmpc_layers.drive_limits import DriveLimits
from tracked_description import Robot
from tracked_lab.reference_feed import ReferenceFeed
from tracked_lab.steering import SteeringOutput
from tracked_types import (
    Odometry,
    PeriodGrid,
    Slip,
    SolverStatus,
    StampOrder,
    Trajectory,
    Twist2,
    VelocityCommand,
)

SHARED = ("pipeline_latency_s", "plan_rate_hz", "seed")
"""Parameters that the lab offers to everybody."""


class Law(Protocol):
    """Twist for one odometry; the reference's pieces reach ahead of it."""

    def steer(self, odometry: Odometry, reference: Trajectory) -> Twist2:
        """The twist to ask of the base; it is brought within the limits afterwards."""
        ...


class ControlPeer:
    """Calls a `Law` once per control period; without a reference it stands."""

    def __init__(self, law: Law, robot: Robot, latency_s: float) -> None:
        self._law = law
        self._limits = DriveLimits.from_robot(robot)
        self._feed = ReferenceFeed(latency_s)
        self._grid = PeriodGrid(robot.control.rate_hz)
        self._order = StampOrder()

    def set_reference(self, reference: Trajectory) -> None:
        """The newest piece of reference."""
        self._feed.add(reference)

    def set_slip(self, slip: Slip) -> None:
        """Slip is nothing that a peer uses."""

    def set_sent(self, command: VelocityCommand) -> None:
        """Nor what became of its commands."""

    def update(self, odometry: Odometry) -> SteeringOutput | None:
        """One command per control period."""
        self._feed.release(odometry.stamp_ns)
        if not self._order.advance(odometry.stamp_ns):
            return None
        if not self._grid.crossed(self._order.previous_ns, odometry.stamp_ns):
            return None
        began_s = time.thread_time()
        twist = Twist2(0.0, 0.0)
        reference = self._feed.newest
        if reference is not None:
            twist = self._limits.clipped(self._law.steer(odometry, reference))
        status = SolverStatus(
            stamp_ns=odometry.stamp_ns,
            layer="lower",
            ok=reference is not None,
            reason="" if reference is not None else "no reference yet",
            iterations=1,
            cost=0.0,
            cpu_time_s=time.thread_time() - began_s,
        )
        return SteeringOutput(VelocityCommand(odometry.stamp_ns, twist), status=status)


def in_robot_frame(odometry: Odometry, states: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Positions of states (n, 3), seen from the robot, (n, 2)."""
    return odometry.pose.inverse().transform(states[:, :2])
