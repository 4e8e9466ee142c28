"""The band of the last update, carried on to now."""

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.initial_bands import pose_count
from tracked_navigation.band.interval_cost import NODE
from tracked_navigation.band.route import Route
from tracked_types import NANOSECONDS_PER_SECOND, Pose2, Twist2, wrap_angle

Array = NDArray[np.float64]
# A robot or an end farther than this from where the band has them: the band is of no use any more.
_LOST_M, _LOST_RAD, _MOVED_END_M = 0.3, 0.6, 1.0
_LEAST_REST_S = 0.4
_FADING_S = 1.0


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
        if not route.rests:
            nodes = _extended(nodes, route.end)
        left_s = max(float(nodes[-1, 5]) - elapsed_s, _LEAST_REST_S)
        carried = _at(nodes, elapsed_s + np.linspace(0.0, left_s, pose_count(left_s) + 1))
        off = np.array([start.x_m, start.y_m, 0.0]) - carried[0, :3]
        off[2] = wrap_angle(start.yaw_rad - float(carried[0, 2]))
        moved_end = float(np.hypot(*(route.end[:2] - nodes[-1, :2])))
        if np.hypot(off[0], off[1]) > _LOST_M or abs(off[2]) > _LOST_RAD or moved_end > _MOVED_END_M:
            return None
        # The error at the start fades along the band.
        carried[:, 5] -= carried[0, 5]
        fading = np.maximum(1.0 - carried[:, 5:6] / _FADING_S, 0.0)
        carried[:, :3] += fading * off
        carried[0, 3:5] = twist.speed_mps, twist.yaw_rate_radps
        return carried


def _at(nodes: Array, times: Array) -> Array:
    """The band (n + 1, 6) at ``times`` (m,): (m, 6). After its end it goes on as it is."""
    interval = np.minimum(np.maximum(np.searchsorted(nodes[:, 5], times, side="right") - 1, 0), len(nodes) - 2)
    first, last = nodes[interval], nodes[interval + 1]
    span = last[:, 5] - first[:, 5]
    share = ((times - first[:, 5]) / span)[:, None]
    found = np.empty((len(times), NODE))
    found[:, 3:5] = first[:, 3:5] + np.minimum(share, 1.0) * (last[:, 3:5] - first[:, 3:5])
    found[:, 5] = times
    # The way within the interval by the mean of the speeds there, and what the band does not keep to, evenly.
    mean = 0.5 * (first[:, 3:5] + found[:, 3:5]) * (times - first[:, 5])[:, None]
    whole = 0.5 * (first[:, 3:5] + last[:, 3:5]) * span[:, None]
    found[:, 2] = first[:, 2] + mean[:, 1] + share[:, 0] * (last[:, 2] - first[:, 2] - whole[:, 1])
    part = np.where(
        np.abs(whole[:, 0]) > 1e-4, mean[:, 0] / np.where(whole[:, 0] == 0.0, 1.0, whole[:, 0]), share[:, 0]
    )
    bend = 0.5 * (found[:, 2] - last[:, 2])
    chord = last[:, :2] - first[:, :2]
    # The chord of the part points a little to the side of that of the whole.
    cosine, sine = np.cos(bend), np.sin(bend)
    found[:, 0] = first[:, 0] + part * (cosine * chord[:, 0] - sine * chord[:, 1])
    found[:, 1] = first[:, 1] + part * (sine * chord[:, 0] + cosine * chord[:, 1])
    return found


def _extended(nodes: Array, end: Array) -> Array:
    """With one more node at the end (3,) if it has moved on."""
    last = nodes[-1]
    way = (end[0] - last[0]) * np.cos(last[2]) + (end[1] - last[1]) * np.sin(last[2])
    if way < 0.01:
        return nodes
    speed = max(float(last[3]), 0.1)
    turn = wrap_angle(float(end[2] - last[2]))
    heading = last[2] + 0.5 * turn
    new = [last[0] + way * np.cos(heading), last[1] + way * np.sin(heading), last[2] + turn, speed, 0.0]
    return np.vstack([nodes, [*new, last[5] + way / speed]])
