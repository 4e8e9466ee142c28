"""The lower layer on a plant that lags and answers late."""

from collections import deque
from dataclasses import replace

import numpy as np
import pytest

from nmpc_layers import LowerLayer, LowerSettings
from nmpc_layers.sent_commands import GroundModel, predict
from nmpc_layers.solver import Weights
from tracked_types import Odometry, PeriodGrid, Pose2, Slip, Trajectory, Twist2, to_nanoseconds

GRID = PeriodGrid(60)
WEIGHTS = Weights(position=20.0, heading=2.0, speed=0.5, yaw_rate=0.2, terminal=2.0)  # for both methods alike


def weaving() -> Trajectory:
    times = np.arange(0.0, 12.0, 0.05)
    rates = 0.9 * np.sin(1.5 * times)
    headings = 0.6 * (1.0 - np.cos(1.5 * times))
    steps = 0.05 * 0.3 * np.column_stack([np.cos(headings), np.sin(headings)])
    places = np.vstack([np.zeros((1, 2)), np.cumsum(steps, axis=0)[:-1]])
    inputs = np.column_stack([np.full_like(times, 0.3), rates])
    return Trajectory(0, "odom", times, np.column_stack([places, headings]), inputs)


def rms_heading_error(robot, method) -> float:
    """Of a slip-free robot that starts on the path and answers 40 ms late with a lag of 60 ms."""
    tuned = LowerSettings.from_robot(robot, method=method, plan_timeout_s=10.0)
    settings = replace(tuned, weights=WEIGHTS, yaw_ratio=1.0)
    layer, plan = LowerLayer(settings), weaving()
    layer.set_plan(plan)
    delay_ns, ground = to_nanoseconds(robot.control.transport_delay_s), GroundModel(lag_s=0.06)
    pose, belts, acting, underway, errors = Pose2(0.0, 0.0, 0.0), Twist2(0.3, 0.0), Twist2(0.3, 0.0), deque(), []
    for index in range(480):
        stamp_ns = GRID.stamp_ns(index)
        covariances = np.eye(3) * 1e-4, np.eye(2) * 1e-4
        layer.set_slip(Slip(stamp_ns, 0.0, 0.0, 1e-4, 1e-4, known=True))
        output = layer.update(Odometry(stamp_ns, "odom", "base_footprint", pose, belts, *covariances))
        if output is not None:
            underway.append(output.command)
        for step in range(4):
            now_ns = stamp_ns + step * (GRID.stamp_ns(index + 1) - stamp_ns) // 4
            while underway and underway[0].stamp_ns + delay_ns <= now_ns:
                acting = underway.popleft().twist
            pose, belts = predict(pose, belts, iter([(1.0 / 240.0, acting)]), ground)
        states, _ = plan.at(GRID.stamp_ns(index + 1), np.zeros(1))
        errors.append(pose.yaw_rad - states[0, 2])
    return float(np.sqrt(np.mean(np.square(errors[60:]))))


@pytest.mark.parametrize("method", ["thesis", "improved"])
def test_either_method_follows(robot, method):
    assert rms_heading_error(robot, method) < 0.15


def test_compensating_delay_and_lag_leaves_a_fraction_of_the_error(robot):
    assert rms_heading_error(robot, "improved") < 0.3 * rms_heading_error(robot, "thesis")
