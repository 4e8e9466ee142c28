"""Slowly out of where something touches the robot, or as good as: no band may begin there."""

import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint
from tracked_navigation.band.clearance import clearances
from tracked_navigation.band.rollout import as_trajectory, integrated
from tracked_navigation.band.surroundings import Surroundings
from tracked_navigation.navigator.view import View
from tracked_types import Pose2, Trajectory

Array = NDArray[np.float64]
SPEED_MPS, YAW_RATE_RADPS = 0.08, 0.4
_RAMP_S, _LASTS_S, _STEP_S = 0.3, 2.5, 0.05
_WAYS = ((-1.0, 0.0), (1.0, 0.0), (-0.7, 0.5), (-0.7, -0.5), (0.7, 0.5), (0.7, -0.5), (0.0, 1.0), (0.0, -1.0))
_GAIN_M, _LOSS_M = 0.02, 0.004
_SEEN_M, _VIEW_M = 1.0, 1.5
_PATIENCE = 5  # updates in which nothing but standing is left, before the robot moves out of the way


class Escape:
    """Watches for being touched, and leads out of it."""

    def __init__(self) -> None:
        self.stop()

    def stop(self) -> None:
        """Nothing of what was touches the robot any more, or matters."""
        self._way: Trajectory | None = None
        self._touched = 0

    def note(self, *, touched: bool) -> None:
        """Whether even braking does not keep the robot from a contact, update by update."""
        self._touched = self._touched + 1 if touched else 0

    def way(self, pose: Pose2, footprint: Footprint, view: View, stamp_ns: int, frame_id: str) -> Trajectory | None:
        """The way out that is under way, or a new one where the robot has been touched for long; None if neither."""
        if self._way is not None and stamp_ns < self._way.end_ns:
            return self._way
        self._way = None
        if self._touched > _PATIENCE:
            self._touched = 0
            around = [view.obstacles_around(pose, _VIEW_M), *(mover.rim for mover in view.movers)]
            self._way = way_out(pose, footprint, np.concatenate(around), stamp_ns, frame_id)
        return self._way


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
