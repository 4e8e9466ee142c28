"""The end of the way: landing on the goal, settling there, and whether that was good enough."""

import enum

import numpy as np

from tracked_navigation.navigator.settings import NavigatorSettings
from tracked_types import Pose2, Trajectory, Twist2, angle_difference, seconds_between

_LANDING_S = 0.8  # before its end a trajectory is no longer replaced
_REST_S = 0.2
_AT_GOAL_M, _AT_GOAL_RAD = 0.04, 0.05


class Verdict(enum.Enum):
    """Where the arrival is."""

    LANDING = "drives the last bit and comes to rest"
    REACHED = "rests at the goal"
    AGAIN = "rests beside the goal and has to drive to it anew"
    MISSED = "rests beside the goal after every attempt"


class Arrival:
    """Judges the end of one request."""

    def __init__(self, settings: NavigatorSettings) -> None:
        self._settings = settings
        self._attempts = 0
        self._rests_since_ns: int | None = None
        self.landing = False

    def update(
        self, goal: Pose2, followed: Trajectory | None, pose: Pose2, twist: Twist2, stamp_ns: int
    ) -> Verdict | None:
        """None while the way is still to be planned. ``followed``: what is being driven, in the frame of the poses."""
        if followed is None or not _ends_at(followed, goal):
            self.landing = False
            return None
        self.landing = seconds_between(followed.end_ns, stamp_ns) <= _LANDING_S
        if not self.landing:
            return None
        if self._rests_at(goal, pose, twist):
            if self._rests_since_ns is None:
                self._rests_since_ns = stamp_ns
            if seconds_between(stamp_ns, self._rests_since_ns) >= _REST_S:
                return Verdict.REACHED
            return Verdict.LANDING
        self._rests_since_ns = None
        if seconds_between(stamp_ns, followed.end_ns) < self._settings.settle_s:
            return Verdict.LANDING
        self._attempts += 1
        self.landing = False
        return Verdict.AGAIN if self._attempts < self._settings.attempts else Verdict.MISSED

    def _rests_at(self, goal: Pose2, pose: Pose2, twist: Twist2) -> bool:
        away, turned = errors(goal, pose)
        near = away <= self._settings.reached_m and turned <= self._settings.reached_rad
        return near and rests(twist, self._settings)


def rests(twist: Twist2, settings: NavigatorSettings) -> bool:
    """Whether a base that moves so is at rest."""
    calm = abs(twist.yaw_rate_radps) <= settings.rest_yaw_rate_radps
    return calm and abs(twist.speed_mps) <= settings.rest_speed_mps


def errors(goal: Pose2, pose: Pose2) -> tuple[float, float]:
    """How far ``pose`` is from ``goal`` (m) and how far turned (rad), both at least 0."""
    away = float(np.hypot(goal.x_m - pose.x_m, goal.y_m - pose.y_m))
    return away, abs(float(angle_difference(goal.yaw_rad, pose.yaw_rad)))


def _ends_at(followed: Trajectory, goal: Pose2) -> bool:
    away, turned = errors(goal, Pose2(*followed.states[-1].tolist()))
    return away <= _AT_GOAL_M and turned <= _AT_GOAL_RAD and not followed.inputs[-1].any()
