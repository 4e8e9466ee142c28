"""The inner loop of path integral control, compiled."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim_bridge.compiled import compiled
from tracked_types import Pose2

KNOTS = 4
"""Commands before and after one that take part in its smoothing."""


def as_seen_from(pose: Pose2, states: NDArray[np.float64]) -> NDArray[np.float64]:
    """States (n, 3) in the frame of ``pose``, their headings without jumps."""
    positions = pose.inverse().transform(states[:, :2])
    return np.column_stack([positions, _near_zero(np.unwrap(states[:, 2]) - pose.yaw_rad)])


def _near_zero(headings: NDArray[np.float64]) -> NDArray[np.float64]:
    shifted: NDArray[np.float64] = headings - 2.0 * math.pi * round(float(headings[0]) / (2.0 * math.pi))
    return shifted


@compiled
def roll_out(
    plan: Any,
    noise: Any,
    reference: Any,
    before: Any,
    limits: Any,
    period_s: float,
    critics: Any,
    pull: Any,
    costs: Any,
) -> None:
    """Cost of every disturbed copy of the plan (steps, 2), into ``costs`` (samples,).

    noise: (samples, steps, 2). reference: (steps, 3) at the ends of the steps, in the frame of the start. before:
    speed and yaw rate at the start. limits: least, greatest, and largest change from step to step, (2,) each.
    critics: weights per step of distance, heading, excess over the limits and speed backwards; at the end of
    distance and heading. pull: weights of plan times disturbance.
    """
    samples, steps = noise.shape[0], noise.shape[1]
    low, high, change = limits
    align, angle, constraint, forward, follow, goal_angle = critics
    for sample in range(samples):
        x, y, yaw, along, pulled, distance, turn = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        speed, rate = before
        for step in range(steps):
            asked_speed = plan[step, 0] + noise[sample, step, 0]
            asked_rate = plan[step, 1] + noise[sample, step, 1]
            speed = min(max(asked_speed, speed - change[0]), speed + change[0])
            rate = min(max(asked_rate, rate - change[1]), rate + change[1])
            excess = max(speed - high[0], low[0] - speed, 0.0) + max(rate - high[1], low[1] - rate, 0.0)
            middle = yaw + 0.5 * period_s * rate
            x += period_s * speed * math.cos(middle)
            y += period_s * speed * math.sin(middle)
            yaw += period_s * rate
            distance = math.sqrt((x - reference[step, 0]) ** 2 + (y - reference[step, 1]) ** 2)
            turn = abs(yaw - reference[step, 2])
            along += align * distance + angle * turn + constraint * excess - forward * min(speed, 0.0)
            pulled += pull[0] * plan[step, 0] * noise[sample, step, 0]
            pulled += pull[1] * plan[step, 1] * noise[sample, step, 1]
        costs[sample] = along / steps + pulled + follow * distance + goal_angle * turn
