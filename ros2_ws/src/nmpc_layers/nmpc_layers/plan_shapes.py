"""From tables of states and commands to trajectories and back."""

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.drive_limits import DriveLimits
from tracked_types import Pose2, Trajectory, Twist2, wrap_angle

Array = NDArray[np.float64]


def step_times(period_s: float, steps: int, start_s: float = 0.0) -> Array:
    """Times of ``steps`` steps and of their end, shape (steps + 1,)."""
    return start_s + period_s * np.arange(steps + 1, dtype=np.float64)


def continuous_headings(states: Array, yaw_rad: float) -> Array:
    """``states`` (n, 3) with headings that do not jump and start within half a turn of ``yaw_rad``.

    The quadratic cost of (5.2.4) knows no circle (erratum 5.2.4).
    """
    result = states.copy()
    headings = np.unwrap(states[:, 2])
    result[:, 2] = headings + (wrap_angle(float(headings[0]) - yaw_rad) + yaw_rad - headings[0])
    return result


def as_trajectory(stamp_ns: int, frame_id: str, times_s: Array, states: Array, commands: Array) -> Trajectory:
    """Trajectory through predicted ``states`` (N + 1, n) under ``commands`` (N, 2), each held for one step.

    A trajectory is linear between its points, so an inner point carries the mean of the commands that
    meet there.
    """
    poses = states[:, :3].copy()
    poses[:, 2] = wrap_angle(poses[:, 2])
    inputs = np.vstack([commands[:1], 0.5 * (commands[1:] + commands[:-1]), commands[-1:]])
    return Trajectory(stamp_ns, frame_id, times_s, poses, inputs)


def stopping(
    stamp_ns: int, frame_id: str, times_s: Array, pose: Pose2, twist: Twist2, limits: DriveLimits, hold_s: float
) -> Trajectory:
    """Keep ``twist`` for ``hold_s``, then brake to standstill within the limits, sampled at ``times_s`` (n,).

    ``pose`` and ``twist`` are those at ``times_s[0]``.
    """
    twists = [limits.braked(twist, max(time - hold_s, 0.0)) for time in (times_s - times_s[0]).tolist()]
    inputs = np.array([[each.speed_mps, each.yaw_rate_radps] for each in twists])
    means, steps = 0.5 * (inputs[1:] + inputs[:-1]), np.diff(times_s)
    headings = pose.yaw_rad + np.concatenate([[0.0], np.cumsum(means[:, 1] * steps)])
    middle = 0.5 * (headings[1:] + headings[:-1])
    moves = means[:, :1] * steps[:, None] * np.column_stack([np.cos(middle), np.sin(middle)])
    places = np.array([pose.x_m, pose.y_m]) + np.vstack([np.zeros((1, 2)), np.cumsum(moves, axis=0)])
    return Trajectory(stamp_ns, frame_id, times_s, np.column_stack([places, wrap_angle(headings)]), inputs)
