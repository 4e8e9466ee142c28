"""Slowly out of where something touches the robot, or as good as: no band may begin there."""

import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint
from tracked_navigation.band.clearance import clearances
from tracked_navigation.band.rollout import as_trajectory, integrated
from tracked_navigation.band.surroundings import Surroundings
from tracked_types import Pose2, Trajectory

Array = NDArray[np.float64]
SPEED_MPS, YAW_RATE_RADPS = 0.08, 0.4
_RAMP_S, _LASTS_S, _STEP_S = 0.3, 2.5, 0.05
_WAYS = ((-1.0, 0.0), (1.0, 0.0), (-0.7, 0.5), (-0.7, -0.5), (0.7, 0.5), (0.7, -0.5), (0.0, 1.0), (0.0, -1.0))
_GAIN_M, _LOSS_M = 0.02, 0.004
_SEEN_M = 1.0


def way_out(pose: Pose2, footprint: Footprint, obstacles: Array, stamp_ns: int, frame_id: str) -> Trajectory | None:
    """The short, slow move that leaves most room to ``obstacles`` (n, 2) and never less than there is; from rest to
    rest, None if no move leaves more room."""
    surroundings = Surroundings(obstacles, np.zeros((0, 2, 2)), np.zeros((0, 2)), np.zeros((0, 5)))
    times = np.arange(0.0, _LASTS_S + 0.5 * _STEP_S, _STEP_S)
    pace = np.minimum(np.minimum(times, _LASTS_S - times) / _RAMP_S, 1.0)
    pace[-1] = 0.0
    best, most = None, _GAIN_M
    for speed, yaw_rate in _WAYS:
        inputs = pace[:, None] * np.array([speed * SPEED_MPS, yaw_rate * YAW_RATE_RADPS])
        states = integrated(pose.as_array(), times, inputs)
        room = clearances(times, states, surroundings, footprint, _SEEN_M)
        gained = float(min(room[-1], _SEEN_M) - room[0])
        if gained > most and room.min() > room[0] - _LOSS_M:
            best, most = as_trajectory(stamp_ns, frame_id, times, states, inputs), gained
    return best
