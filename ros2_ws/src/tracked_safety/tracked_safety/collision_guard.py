"""Keeps the robot from driving into what the lidar sees, whoever commands it.

A command passes if the robot, once it obeys, can still brake to rest along the same arc before anything touches
its footprint; if not, it is slowed until it can. What is close in time slows, what is too close stops.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracked_safety.guard_settings import GuardSettings
from tracked_safety.scan_view import ScanView
from tracked_types import GuardAction, LaserScan, Odometry, Twist2

Array = NDArray[np.float64]
_STEP_M = 0.025
_STANDING_MPS = 1e-6
_TURN_RADIUS_M = 0.5  # of a turn on the spot, to measure it in metres at about the corners
_ALONGSIDE_M = 0.001
_REST = Twist2(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Permitted:
    """What may pass of a command. reason: in words, empty if all of it passes.

    nearest_m: way along the arc to the first contact with the margin, infinite if there is none in sight.
    """

    twist: Twist2
    action: GuardAction = GuardAction.PASSING
    reason: str = ""
    nearest_m: float = math.inf


class CollisionGuard:
    """Judges commands by the newest scan, carried on by how the robot moves."""

    def __init__(self, settings: GuardSettings) -> None:
        self.settings = settings
        self.view = ScanView(settings)
        footprint = settings.footprint
        self._corner_m = math.hypot(max(footprint.front_m, footprint.rear_m), footprint.half_width_m)

    def add_odometry(self, odometry: Odometry) -> None:
        """Take in how the robot moves."""
        self.view.add_odometry(odometry)

    def add_scan(self, scan: LaserScan) -> None:
        """Take in a scan; raises `ScanRefused` if it cannot be used."""
        self.view.add_scan(scan)

    def permitted(self, wanted: Twist2, now_ns: int, *, gently: bool = True, attended: bool = False) -> Permitted:
        """As much of the command as is safe at ``now_ns``, its curvature kept.

        gently: also keep what lies ahead away in time, rather than brake for it at the last moment. attended: a person
        steers, and may take the robot past what an algorithm may not.
        """
        pace = _pace(wanted)
        if pace < _STANDING_MPS:
            return Permitted(wanted)
        points = self.view.points(now_ns)
        if isinstance(points, str):
            return Permitted(_REST, GuardAction.BLIND, points)
        return self._slowed(wanted, pace, points, gently, attended)

    def _slowed(self, wanted: Twist2, pace: float, points: Array, gently: bool, attended: bool) -> Permitted:
        settings = self.settings
        late_s, braking = settings.reaction_s + settings.delay_s, settings.braking_mps2
        look_m = pace * max(late_s, settings.approach_s if gently else 0.0) + pace**2 / (2.0 * braking)
        reach = self._corner_m + settings.margin_m + look_m
        near = points[np.hypot(points[:, 0], points[:, 1]) < reach]
        if not len(near):
            return Permitted(wanted)
        ways = np.linspace(0.0, look_m, max(2, math.ceil(look_m / _STEP_M) + 1))
        gaps = settings.footprint.distance(_along(near, wanted, ways / pace)) - settings.margin_m
        free_m = 0.0 if gaps[0].min() <= 0.0 else _first_contact(ways, gaps.min(axis=1))
        if free_m >= look_m:
            return Permitted(wanted)
        # v late + v^2 / 2a = free way, solved for v; and what is far enough to brake is still approached gently.
        most = braking * (math.sqrt(late_s**2 + 2.0 * free_m / braking) - late_s)
        if gently and settings.approach_s > 0.0:
            most = min(most, free_m / settings.approach_s)
        if most >= pace:
            return Permitted(wanted)
        if most < settings.crawl_mps:
            # Who comes fast has to brake as if to rest: a crawl is for who is slow already.
            is_fast = not gently and pace > 1.5 * settings.crawl_mps
            crawling = Permitted(_REST) if is_fast else self._crawling(wanted, pace, near, attended)
            if crawling.twist != _REST:
                return replace(crawling, nearest_m=free_m)
            return Permitted(_REST, GuardAction.HOLDING, "an obstacle is in the way", free_m)
        return Permitted(_scaled(wanted, most / pace), GuardAction.SLOWING, "an obstacle is in the way", free_m)

    def _crawling(self, wanted: Twist2, pace: float, points: Array, attended: bool) -> Permitted:
        """The margin is used up: no faster than a crawl, and nothing within the tight margin may come nearer."""
        settings = self.settings
        late_s = settings.reaction_s + settings.delay_s
        stopping_m = settings.crawl_mps * late_s + settings.crawl_mps**2 / (2.0 * settings.braking_mps2)
        gaps = settings.footprint.distance(_along(points, wanted, np.linspace(0.0, stopping_m, 4) / pace))
        now, soon = gaps[0], gaps[1:]
        # What touches already must be left: to slide along it is for a person to decide.
        touched = now <= 0.0
        leaves = attended or (soon[:, touched] > now[touched]).all()
        if not leaves or (soon < np.minimum(now - _ALONGSIDE_M, settings.tight_margin_m)).any():
            return Permitted(_REST)
        return Permitted(
            _scaled(wanted, min(1.0, settings.crawl_mps / pace)), GuardAction.CRAWLING, "an obstacle is near"
        )


def _along(points: Array, twist: Twist2, times_s: Array) -> Array:
    """Points (n, 2) as the base sees them after each of the times (k,) at a constant twist, (k, n, 2)."""
    turns = twist.yaw_rate_radps * times_s
    ways = twist.speed_mps * times_s
    ahead = ways * np.sinc(turns / np.pi)
    aside = ways * np.sin(0.5 * turns) * np.sinc(0.5 * turns / np.pi)
    x, y = points[:, 0] - ahead[:, None], points[:, 1] - aside[:, None]
    cosine, sine = np.cos(turns)[:, None], np.sin(turns)[:, None]
    return np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=-1)


def _first_contact(ways: Array, gaps: Array) -> float:
    """Way at which the gap closes, between the samples on a straight line; infinite if it does not."""
    met = np.flatnonzero(gaps <= 0.0)
    if not len(met):
        return math.inf
    index = met[0]
    before, after = gaps[index - 1], gaps[index]
    return float(ways[index - 1] + before / (before - after) * (ways[index] - ways[index - 1]))


def _pace(twist: Twist2) -> float:
    """Speed (m/s) of the robot or, where it turns, of about its corners."""
    return max(abs(twist.speed_mps), _TURN_RADIUS_M * abs(twist.yaw_rate_radps))


def _scaled(twist: Twist2, share: float) -> Twist2:
    return Twist2(share * twist.speed_mps, share * twist.yaw_rate_radps)
