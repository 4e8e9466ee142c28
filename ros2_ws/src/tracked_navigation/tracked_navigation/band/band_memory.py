"""The band of the last update, carried on to now."""

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.initial_bands import as_nodes, pose_count
from tracked_navigation.band.route import Route
from tracked_types import NANOSECONDS_PER_SECOND, Pose2, Twist2, wrap_angle

Array = NDArray[np.float64]
# A robot or an end farther than this from where the band has them: the band is of no use any more.
_LOST_M, _LOST_RAD, _MOVED_END_M = 0.3, 0.6, 1.0
_LEAST_REST_S = 0.4


class BandMemory:
    """Remembers one band and re-times it."""

    def __init__(self) -> None:
        self._nodes: Array | None = None
        self._stamp_ns = 0

    def keep(self, nodes: Array, stamp_ns: int) -> None:
        """Remember ``nodes`` (n + 1, 6), whose first one is at ``stamp_ns``."""
        self._nodes, self._stamp_ns = nodes, stamp_ns

    def forget(self) -> None:
        """Start anew."""
        self._nodes = None

    def carried_on(self, start: Pose2, twist: Twist2, route: Route, stamp_ns: int) -> Array | None:
        """What is left of the band, from ``start`` to the end of ``route``, its poses evenly spaced in time again;
        None if it does not fit."""
        nodes = self._nodes
        elapsed_s = (stamp_ns - self._stamp_ns) / NANOSECONDS_PER_SECOND
        if nodes is None or not 0.0 <= elapsed_s < float(nodes[-1, 5]):
            return None
        here = np.array([np.interp(elapsed_s, nodes[:, 5], nodes[:, axis]) for axis in range(3)])
        turn = wrap_angle(start.yaw_rad - float(here[2]))
        moved_end = float(np.hypot(*(route.end[:2] - nodes[-1, :2])))
        if np.hypot(start.x_m - here[0], start.y_m - here[1]) > _LOST_M or abs(turn) > _LOST_RAD:
            return None
        if moved_end > _MOVED_END_M:
            return None
        later = nodes[nodes[:, 5] > elapsed_s + 1e-3]
        first = np.array([start.x_m, start.y_m, here[2] + turn, elapsed_s])
        timeline = np.vstack([first, later[:, [0, 1, 2, 5]]])
        if moved_end > 0.02 and not route.rests:
            mean_mps = max(float(np.hypot(*(nodes[-1, :2] - nodes[0, :2]))) / float(nodes[-1, 5]), 0.1)
            yaw = float(timeline[-1, 2]) + wrap_angle(float(route.end[2] - timeline[-1, 2]))
            timeline = np.vstack([timeline, [*route.end[:2], yaw, timeline[-1, 3] + moved_end / mean_mps]])
        timeline[-1, 3] = max(timeline[-1, 3], elapsed_s + _LEAST_REST_S)
        return as_nodes(timeline, pose_count(float(timeline[-1, 3]) - elapsed_s), twist)
