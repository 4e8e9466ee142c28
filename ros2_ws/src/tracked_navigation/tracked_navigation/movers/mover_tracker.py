"""Follows what moves: a Kalman filter with constant velocity for each group of points that the map does not explain."""

import itertools
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from tracked_navigation.movers.clusters import Cluster, clusters_of
from tracked_types import Mover, seconds_between
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]
_UNMATCHED = 1e6


@dataclass(frozen=True, slots=True, kw_only=True)
class MoverSettings:
    """What counts as a mover, and how it may move."""

    gap_m: float = setting(0.25, "points farther apart belong to different things", unit="m", low=0.01, high=2.0)
    least_points: int = setting(3, "points that a thing must show", low=1, high=100)
    largest_m: float = setting(1.2, "wider things are not followed", unit="m", low=0.1, high=10.0)
    body_radius_m: float = setting(0.25, "least radius of what is followed", unit="m", low=0.05, high=2.0)
    agility_mps2: float = setting(1.0, "standard deviation of its acceleration", unit="m/s^2", low=0.01, high=20.0)
    spot_deviation_m: float = setting(
        0.06, "standard deviation of where a group of points says that it is", unit="m", low=0.001, high=1.0
    )
    fastest_mps: float = setting(2.5, "nothing is followed that is faster", unit="m/s", low=0.1, high=20.0)
    moving_mps: float = setting(0.15, "speed from which on it counts as moving", unit="m/s", low=0.0, high=5.0)
    confirmations: int = setting(3, "scans that must show it before it is told", low=1, high=50)
    forgotten_after_s: float = setting(1.0, "how long it is predicted unseen", unit="s", low=0.1, high=30.0)

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(slots=True)
class _Track:
    identity: int
    state: Array
    covariance: Array
    radius_m: float
    seen_ns: int
    stamp_ns: int
    sightings: int = 1
    moved: bool = False
    born_m: Array = field(default_factory=lambda: np.zeros(2))


class MoverTracker:
    """Takes points that the map does not explain, scan by scan, and gives what moves among them.

    Something that has stood still ever since it was first seen is an obstacle, not a mover, and is not told.
    """

    def __init__(self, settings: MoverSettings, frame_id: str) -> None:
        self._settings, self._frame_id = settings, frame_id
        self._tracks: list[_Track] = []
        self._identities = itertools.count(1)

    def restart(self) -> None:
        """Forget everything: the frame has jumped."""
        self._tracks = []

    def update(self, points: Array, stamp_ns: int) -> tuple[Mover, ...]:
        """Points (n, 2) in the tracker's frame, in the order of their beams. A stamp that is not newer starts over.

        Raises
        ------
        ValueError: if a point is not finite.
        """
        if not np.isfinite(points).all():
            raise ValueError("points must be finite")
        if any(track.stamp_ns >= stamp_ns for track in self._tracks):
            self.restart()
        settings = self._settings
        clusters = clusters_of(
            points, gap_m=settings.gap_m, least_points=settings.least_points, largest_m=settings.largest_m
        )
        for track in self._tracks:
            self._predict(track, stamp_ns)
        free = set(range(len(clusters)))
        for track, number in self._assigned(clusters):
            self._correct(track, clusters[number], stamp_ns)
            free.discard(number)
        self._tracks = [track for track in self._tracks if self._kept(track, stamp_ns)]
        self._tracks += [self._born(clusters[number], stamp_ns) for number in sorted(free)]
        return tuple(self._told(track) for track in self._tracks if self._is_mover(track))

    def _predict(self, track: _Track, stamp_ns: int) -> None:
        period = seconds_between(stamp_ns, track.stamp_ns)
        carry = np.eye(4)
        carry[0, 2] = carry[1, 3] = period
        push = np.vstack([0.5 * period**2 * np.eye(2), period * np.eye(2)]) * self._settings.agility_mps2
        track.state = carry @ track.state
        track.covariance = carry @ track.covariance @ carry.T + push @ push.T
        track.stamp_ns = stamp_ns

    def _assigned(self, clusters: tuple[Cluster, ...]) -> list[tuple[_Track, int]]:
        """Pairs of least total distance, none of them improbable."""
        if not self._tracks or not clusters:
            return []
        spot = self._settings.spot_deviation_m**2 * np.eye(2)
        cost = np.full((len(self._tracks), len(clusters)), _UNMATCHED)
        for row, track in enumerate(self._tracks):
            spread = np.linalg.inv(track.covariance[:2, :2] + spot)
            for column, cluster in enumerate(clusters):
                offset = cluster.centre_m - track.state[:2]
                distance = float(offset @ spread @ offset)
                if distance < 13.8:  # 99.9 % of a chi-square of two degrees of freedom
                    cost[row, column] = distance
        rows, columns = linear_sum_assignment(cost)
        return [
            (self._tracks[row], int(column))
            for row, column in zip(rows, columns, strict=True)
            if cost[row, column] < _UNMATCHED
        ]

    def _correct(self, track: _Track, cluster: Cluster, stamp_ns: int) -> None:
        settings = self._settings
        spread = track.covariance[:2, :2] + settings.spot_deviation_m**2 * np.eye(2)
        gain = track.covariance[:, :2] @ np.linalg.inv(spread)
        track.state = track.state + gain @ (cluster.centre_m - track.state[:2])
        covariance = track.covariance - gain @ track.covariance[:2, :]
        track.covariance = 0.5 * (covariance + covariance.T)
        speed = float(np.hypot(*track.state[2:]))
        if speed > settings.fastest_mps:
            track.state[2:] *= settings.fastest_mps / speed
        track.radius_m = max(settings.body_radius_m, 0.8 * track.radius_m + 0.2 * cluster.radius_m)
        track.seen_ns = stamp_ns
        track.sightings += 1
        gone = float(np.hypot(*(track.state[:2] - track.born_m)))
        deviation = float(np.sqrt(np.linalg.eigvalsh(track.covariance[2:, 2:]).max()))
        if gone > 0.15 and speed > max(settings.moving_mps, 2.0 * deviation):
            track.moved = True

    def _kept(self, track: _Track, stamp_ns: int) -> bool:
        patience = self._settings.forgotten_after_s if track.sightings >= self._settings.confirmations else 0.25
        return seconds_between(stamp_ns, track.seen_ns) <= patience

    def _born(self, cluster: Cluster, stamp_ns: int) -> _Track:
        settings = self._settings
        covariance = np.diag([settings.spot_deviation_m**2] * 2 + [0.7**2] * 2)
        state = np.concatenate([cluster.centre_m, np.zeros(2)])
        radius = max(settings.body_radius_m, cluster.radius_m)
        identity = next(self._identities)
        return _Track(identity, state, covariance, radius, stamp_ns, stamp_ns, born_m=cluster.centre_m.copy())

    def _is_mover(self, track: _Track) -> bool:
        return track.moved and track.sightings >= self._settings.confirmations

    def _told(self, track: _Track) -> Mover:
        return Mover(
            track.identity,
            track.stamp_ns,
            self._frame_id,
            track.state[:2].copy(),
            track.state[2:].copy(),
            track.covariance.copy(),
            track.radius_m,
        )
