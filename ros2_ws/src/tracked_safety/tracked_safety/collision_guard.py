"""Keeps the robot from driving into what the lidar sees, whoever commands it.

A command passes if the robot, once it obeys, can still brake to rest along the same arc before anything touches
its footprint; if not, it is slowed until it can. What is close in time slows, what is too close stops.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint, Robot
from tracked_types import Pose2, Twist2, seconds_between
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]
_STEPS = 24
_STANDING_MPS = 1e-6
_TURN_RADIUS_M = 0.5  # of a turn on the spot, to measure it in metres at about the corners


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardSettings:
    """How the robot brakes, and how much room it keeps."""

    footprint: Footprint
    braking_mps2: float
    delay_s: float  # from a command's stamp to the belts at its speed, on average

    margin_m: float = setting(0.06, "room that is kept around the robot", unit="m", low=0.0, high=1.0)
    scan_timeout_s: float = setting(
        0.3, "a scan older than this is none, and the robot stops", unit="s", low=0.05, high=5.0
    )
    reaction_s: float = setting(0.1, "time until the next scan has been looked at", unit="s", low=0.0, high=2.0)
    approach_s: float = setting(
        1.0, "what lies ahead is kept this far away in time; 0: only brake", unit="s", low=0.0, high=10.0
    )
    escape_mps: float = setting(
        0.08, "speed at which the robot may back off from what is within the margin", unit="m/s", low=0.0, high=0.5
    )

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: float) -> "GuardSettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields."""
        return cls(
            footprint=Footprint.from_robot(robot),
            braking_mps2=robot.limits.braking_mps2,
            delay_s=robot.control.transport_delay_s + robot.tracks.motor_time_constant_s,
            **tuning,
        )


@dataclass(frozen=True, slots=True)
class Permitted:
    """What may pass of a command. reason: empty if all of it; nearest_m: way along the arc to the first contact."""

    twist: Twist2
    reason: str = ""
    nearest_m: float = math.inf


class CollisionGuard:
    """Judges commands by the newest scan, carried on by how the robot moves."""

    def __init__(self, settings: GuardSettings) -> None:
        self.settings = settings
        self._points = np.zeros((0, 2))
        self._stamp_ns: int | None = None

    def set_scan(self, points: Array, stamp_ns: int) -> None:
        """Points (n, 2) in the base's frame as of the stamp; a scan that is older than the last one is ignored.

        Raises
        ------
        ValueError: if a point is not finite.
        """
        if not np.isfinite(points).all():
            raise ValueError("points must be finite")
        if self._stamp_ns is None or stamp_ns > self._stamp_ns:
            self._points, self._stamp_ns = points, stamp_ns

    def forget(self) -> None:
        """The clock has jumped: wait for a new scan."""
        self._stamp_ns = None

    def permitted(self, wanted: Twist2, moving: Twist2, now_ns: int) -> Permitted:
        """As much of the command as is safe, its curvature kept; ``moving`` is how the robot moves now."""
        if _pace(wanted) < _STANDING_MPS:
            return Permitted(Twist2(0.0, 0.0))
        age_s = math.inf if self._stamp_ns is None else seconds_between(now_ns, self._stamp_ns)
        if age_s > self.settings.scan_timeout_s or age_s < -self.settings.scan_timeout_s:
            reason = "no scan yet" if self._stamp_ns is None else f"the scan is {abs(age_s):.2f} s old"
            return Permitted(Twist2(0.0, 0.0), reason)
        points = _moved_back(self._points, moving, max(age_s, 0.0))
        return self._slowed(wanted, self._near(points))

    def _near(self, points: Array) -> Array:
        """Those that any stop of this robot could touch."""
        footprint, settings = self.settings.footprint, self.settings
        fastest = 2.0
        reach = math.hypot(max(footprint.front_m, footprint.rear_m), footprint.half_width_m) + settings.margin_m
        reach += fastest * (settings.approach_s + settings.reaction_s + settings.delay_s)
        reach += fastest**2 / (2.0 * settings.braking_mps2)
        near: Array = points[np.hypot(points[:, 0], points[:, 1]) < reach]
        return near

    def _slowed(self, wanted: Twist2, points: Array) -> Permitted:
        if not len(points):
            return Permitted(wanted)
        settings = self.settings
        pace = _pace(wanted)
        late_s = settings.reaction_s + settings.delay_s
        look_m = pace * max(late_s, settings.approach_s) + pace**2 / (2.0 * settings.braking_mps2)
        free_m, touching = self._free_way(wanted, pace, look_m, points)
        if touching:
            share = min(1.0, settings.escape_mps / pace)
            if self._backs_off(wanted, pace, points):
                return Permitted(_scaled(wanted, share), "backing off from an obstacle", 0.0)
            return Permitted(Twist2(0.0, 0.0), "an obstacle touches the robot's margin", 0.0)
        if free_m >= look_m:
            return Permitted(wanted)
        # v late + v^2 / 2a = free way, solved for v; and what is far enough to brake is still approached gently.
        braking = settings.braking_mps2
        stoppable = braking * (math.sqrt(late_s**2 + 2.0 * free_m / braking) - late_s)
        gentle = free_m / settings.approach_s if settings.approach_s > 0.0 else math.inf
        share = min(1.0, min(stoppable, max(gentle, 0.0)) / pace)
        if share >= 1.0:
            return Permitted(wanted)
        if share * pace < 0.005:
            return Permitted(Twist2(0.0, 0.0), f"an obstacle {free_m:.2f} m ahead", free_m)
        return Permitted(_scaled(wanted, share), f"slowed for an obstacle {free_m:.2f} m ahead", free_m)

    def _free_way(self, wanted: Twist2, pace: float, look_m: float, points: Array) -> tuple[float, bool]:
        """Way (m, at the pace) along the arc until the first point touches the margin; whether one does already."""
        grown = self.settings.footprint.grown(self.settings.margin_m)
        ways = np.linspace(0.0, look_m, _STEPS + 1)
        gaps = np.array([grown.distance(_moved_back(points, wanted, way / pace)).min() for way in ways])
        if gaps[0] <= 0.0:
            return 0.0, True
        met = np.flatnonzero(gaps <= 0.0)
        if not len(met):
            return math.inf, False
        before, after = gaps[met[0] - 1], gaps[met[0]]
        share = before / (before - after)
        return float(ways[met[0] - 1] + share * (ways[met[0]] - ways[met[0] - 1])), False

    def _backs_off(self, wanted: Twist2, pace: float, points: Array) -> bool:
        """Whether the command leads away from every point that is within the margin."""
        footprint = self.settings.footprint
        now = footprint.distance(points)
        soon = footprint.distance(_moved_back(points, wanted, 0.03 / pace))
        close = now <= self.settings.margin_m
        return bool((soon[close] > now[close]).all() and (soon > np.minimum(now, 0.02)).all())


def _moved_back(points: Array, twist: Twist2, duration_s: float) -> Array:
    """Points in the base's frame after it has moved with a constant twist."""
    turn = twist.yaw_rate_radps * duration_s
    way = twist.speed_mps * duration_s
    if abs(turn) < 1e-9:
        moved = Pose2(way, 0.0, turn)
    else:
        radius = way / turn
        moved = Pose2(radius * math.sin(turn), radius * (1.0 - math.cos(turn)), turn)
    return moved.inverse().transform(points)


def _pace(twist: Twist2) -> float:
    """Speed (m/s) of the robot or, where it turns, of about its corners."""
    return max(abs(twist.speed_mps), _TURN_RADIUS_M * abs(twist.yaw_rate_radps))


def _scaled(twist: Twist2, share: float) -> Twist2:
    return Twist2(share * twist.speed_mps, share * twist.yaw_rate_radps)
