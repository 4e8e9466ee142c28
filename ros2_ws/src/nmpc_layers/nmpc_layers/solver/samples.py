"""Problems along a winding path, for tests and benchmarks."""

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver.motion_model import Motion, MotionParameters
from nmpc_layers.solver.problem import Problem
from nmpc_layers.solver.terminal_weight import TerminalWeight
from nmpc_layers.solver.weights import Weights

Array = NDArray[np.float64]

KICK_EVERY = 25
WEIGHTS = Weights(position=20.0, heading=2.0, speed=1.0, yaw_rate=0.5, terminal=5.0)
TERMINAL = TerminalWeight.of([[320.0, 10.0, 0.0], [10.0, 360.0, 19.0], [0.0, 19.0, 12.0]])
LOW, HIGH = np.array([-0.4, -1.3]), np.array([0.5, 1.3])


def winding_path(period_s: float, count: int, speed_mps: float = 0.35) -> tuple[Array, Array]:
    """Poses (count, 3) with continuous headings and inputs (count, 2) of a path that sways to both sides."""
    times = period_s * np.arange(count)
    inputs = np.column_stack([np.full(count, speed_mps), 0.8 * np.sin(1.1 * times)])
    headings = np.concatenate([[0.0], np.cumsum(period_s * inputs[:-1, 1])])
    middle = headings[:-1] + 0.5 * period_s * inputs[:-1, 1]
    steps = period_s * inputs[:-1, :1] * np.column_stack([np.cos(middle), np.sin(middle)])
    places = np.vstack([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    return np.column_stack([places, headings]), inputs


def winding_problems(
    motion: Motion,
    horizon: int,
    period_s: float,
    count: int,
    seed: int,
    speed_mps: float = 0.35,
    terminal: TerminalWeight | None = None,
) -> list[Problem]:
    """Consecutive problems along the winding path: noise on every start, a kick of 0.12 m and 0.35 rad on every 25th.

    With Motion.LAG the belts slip, more while turning.
    """
    generator = np.random.default_rng(seed)
    poses, inputs = winding_path(period_s, count + horizon + 1, speed_mps)
    problems = []
    for index in range(count):
        offset = generator.normal(0.0, [0.01, 0.01, 0.02])
        if index % KICK_EVERY == 0:
            offset = float(generator.choice([-1.0, 1.0])) * np.array([0.0, 0.12, 0.35])
        start, parameters = poses[index] + offset, MotionParameters(period_s=period_s)
        if motion is Motion.LAG:
            start = np.concatenate([start, inputs[index] * generator.uniform(0.8, 1.2, 2)])
            parameters = MotionParameters(
                period_s=period_s,
                speed_slip_mps=-0.02,
                yaw_slip_radps=-0.1 * float(inputs[index, 1]),
                yaw_efficiency=0.8,
            )
        problems.append(
            Problem(
                start,
                poses[index : index + horizon + 1],
                inputs[index : index + horizon],
                LOW,
                HIGH,
                parameters,
                WEIGHTS,
                terminal,
            )
        )
    return problems
