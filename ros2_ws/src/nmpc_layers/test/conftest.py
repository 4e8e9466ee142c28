"""What several test files share."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tracked_description import Robot, load_robot
from tracked_types import Odometry, Pose2, Slip, Trajectory, Twist2, to_nanoseconds


@pytest.fixture(scope="session")
def robot() -> Robot:
    return load_robot()


@pytest.fixture(scope="session")
def odometry_at() -> Callable[..., Odometry]:
    """Maker of odometry at a time (s)."""

    def make(time_s: float, x=0.0, y=0.0, yaw=0.0, speed=0.0, yaw_rate=0.0) -> Odometry:
        pose, twist = Pose2(x, y, yaw), Twist2(speed, yaw_rate)
        stamp_ns = to_nanoseconds(time_s)
        return Odometry(stamp_ns, "odom", "base_footprint", pose, twist, np.eye(3) * 1e-4, np.eye(2) * 1e-4)

    return make


@pytest.fixture(scope="session")
def slip_at() -> Callable[..., Slip]:
    """Maker of slip estimates at a time (s)."""
    return lambda time_s, yaw_rate=0.0, known=True: Slip(to_nanoseconds(time_s), 0.0, yaw_rate, 1e-4, 1e-4, known=known)


@pytest.fixture(scope="session")
def straight() -> Callable[..., Trajectory]:
    """Maker of a reference that drives along x at constant speed; at its stamp it is at x = speed * time."""

    def make(time_s: float, speed=0.3, duration_s=4.0) -> Trajectory:
        times = np.arange(0.0, duration_s, 0.05)
        zeros = np.zeros_like(times)
        states = np.column_stack([speed * (time_s + times), zeros, zeros])
        inputs = np.column_stack([np.full_like(times, speed), zeros])
        return Trajectory(to_nanoseconds(time_s), "odom", times, states, inputs)

    return make


@pytest.fixture(scope="session")
def resting() -> Callable[..., Trajectory]:
    """Maker of a reference that stands at a pose."""

    def make(time_s: float, x=0.0, y=0.0, yaw=0.0) -> Trajectory:
        times = np.arange(0.0, 3.01, 0.05)
        states = np.tile([x, y, yaw], (len(times), 1))
        return Trajectory(to_nanoseconds(time_s), "odom", times, states, np.zeros((len(times), 2)))

    return make


@pytest.fixture(scope="session")
def spoiled() -> Callable[..., Odometry]:
    """Odometry with another value of one field of its pose."""
    return lambda odometry, **changes: replace(odometry, pose=replace(odometry.pose, **changes))
