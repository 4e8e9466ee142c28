"""From a band to the trajectory that is handed out: every pose follows from the inputs."""

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.motion_limits import MotionLimits
from tracked_types import Trajectory, wrap_angle

Array = NDArray[np.float64]
LONGEST_STEP_S = 0.06


def rolled_out(nodes: Array, limits: MotionLimits, *, rests: bool) -> tuple[Array, Array, Array]:
    """Times (m,), states (m, 3) with continuous headings and inputs (m, 2) of the band ``nodes`` (n + 1, 6).

    Inputs are linear between the nodes, the first as measured, the others brought within ``limits``, and zero at the
    end if the band ``rests``. Every state follows from the one before by the means of the inputs and the mean heading.
    """
    nodes = nodes.copy()
    nodes[1:, 3:5] = clipped(nodes[1:, 3:5], limits)
    if rests:
        nodes[-1, 3:5] = 0.0
    spans = np.diff(nodes[:, 5])
    parts = np.maximum(np.ceil(spans / LONGEST_STEP_S).astype(np.intp), 1)
    interval = np.repeat(np.arange(len(spans)), parts)
    place = np.arange(1, len(interval) + 1) - np.repeat(np.cumsum(parts) - parts, parts)
    share = place / parts[interval]
    times = np.concatenate([[0.0], nodes[interval, 5] + share * spans[interval]])
    inputs = np.empty((len(times), 2))
    inputs[0] = nodes[0, 3:5]
    inputs[1:] = nodes[interval, 3:5] + share[:, None] * (nodes[interval + 1, 3:5] - nodes[interval, 3:5])
    return times, integrated(nodes[0, :3], times, inputs), inputs


def integrated(start: Array, times: Array, inputs: Array) -> Array:
    """States (m, 3) from ``start`` (3,) under ``inputs`` (m, 2), by the midpoint rule (erratum 5.2.4)."""
    ways = (0.5 * np.diff(times))[:, None] * (inputs[1:] + inputs[:-1])
    states = np.empty((len(times), 3))
    states[0] = start
    states[1:, 2] = start[2] + np.cumsum(ways[:, 1])
    middle = 0.5 * (states[1:, 2] + states[:-1, 2])
    states[1:, 0] = start[0] + np.cumsum(ways[:, 0] * np.cos(middle))
    states[1:, 1] = start[1] + np.cumsum(ways[:, 0] * np.sin(middle))
    return states


def clipped(inputs: Array, limits: MotionLimits) -> Array:
    """Speeds and yaw rates (n, 2) within the box and the track speed, which keeps their ratio."""
    low = [limits.speed_min_mps, -limits.yaw_rate_radps]
    high = [limits.speed_max_mps, limits.yaw_rate_radps]
    within = np.minimum(np.maximum(inputs, low), high)
    tracks = np.abs(within[:, 0]) + limits.half_gauge_m * np.abs(within[:, 1])
    within *= np.minimum(1.0, limits.track_speed_mps / np.maximum(tracks, 1e-9))[:, None]
    return within


def as_trajectory(stamp_ns: int, frame_id: str, times: Array, states: Array, inputs: Array) -> Trajectory:
    """The same with wrapped headings."""
    poses = states.copy()
    poses[:, 2] = wrap_angle(poses[:, 2])
    return Trajectory(stamp_ns, frame_id, times, poses, inputs)
