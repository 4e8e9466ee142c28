"""Final approach: reaches the pose at which a reference comes to rest."""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from nmpc_layers.manoeuvre import ManoeuvreRates, manoeuvre
from tracked_types import Odometry, Pose2, Trajectory, angle_difference, seconds_between, to_nanoseconds

STILL = 1e-6  # inputs and pose differences below this are a reference at rest
PUSHED_M = 0.15  # farther than this from the manoeuvre it is planned anew
PUSHED_RAD = 0.6


class Phase(Enum):
    """What the approach does."""

    FOLLOWING = "following the reference"
    ARRIVING = "waiting for the robot to come to rest"
    APPROACHING = "driving to the goal pose"
    PARKED = "at the goal pose"
    GAVE_UP = "goal pose not reached within the permitted attempts"


@dataclass(frozen=True, slots=True, kw_only=True)
class ApproachSettings:
    """When the goal pose counts as reached and how the rest of the way is driven."""

    position_tolerance_m: float
    yaw_tolerance_rad: float
    attempts: int
    rates: ManoeuvreRates
    rest_speed_mps: float = 0.02
    rest_yaw_rate_radps: float = 0.05
    settle_s: float = 0.6


class GoalApproach:
    """Replaces a reference that has come to rest by one that leads to its pose.

    A resting target leaves the controller of (5.2.4) centimetres short (erratum 5.2.20): it cannot move
    sideways. Once robot and reference are at rest, a short manoeuvre with inputs of its own leads to the
    goal; it is repeated until the pose is within tolerance, then the robot is held where it stands.
    """

    def __init__(self, settings: ApproachSettings) -> None:
        self._settings = settings
        self.restart()

    def restart(self) -> None:
        """Forget the goal."""
        self.phase = Phase.FOLLOWING
        self._goal: Pose2 | None = None
        self._manoeuvre: Trajectory | None = None
        self._attempts = 0
        self._arriving_since_ns = 0

    def reference(self, given: Trajectory, odometry: Odometry, start_ns: int, horizon_s: float) -> Trajectory:
        """What to follow instead of ``given``, for a horizon from ``start_ns`` of ``horizon_s``."""
        goal = resting_pose(given, odometry.stamp_ns, start_ns, horizon_s)
        if goal is None:
            self.restart()
            return given
        if self._goal is None or _distance(self._goal, goal) > STILL:
            self.restart()
            self._goal, self.phase = goal, Phase.ARRIVING
            self._arriving_since_ns = odometry.stamp_ns
        self._advance(goal, odometry, start_ns)
        if self.phase is Phase.ARRIVING:
            return given
        if self.phase is Phase.APPROACHING and self._manoeuvre is not None:
            return self._manoeuvre
        return _standing(odometry)

    def _advance(self, goal: Pose2, odometry: Odometry, start_ns: int) -> None:
        if self.phase is Phase.ARRIVING:
            waited_s = seconds_between(odometry.stamp_ns, self._arriving_since_ns)
            if self._rests(odometry) or waited_s > 3.0 * self._settings.settle_s:
                self._judge(goal, odometry, start_ns)
        elif self.phase is Phase.APPROACHING and self._manoeuvre is not None:
            settled_ns = self._manoeuvre.end_ns + to_nanoseconds(self._settings.settle_s)
            if odometry.stamp_ns >= settled_ns or self._is_pushed(self._manoeuvre, odometry):
                self._judge(goal, odometry, start_ns)
        elif self._off_by(goal, odometry) > 2.0:
            # Moved by somebody else: try again from the start.
            self._attempts = 0
            self._judge(goal, odometry, start_ns)

    def _judge(self, goal: Pose2, odometry: Odometry, start_ns: int) -> None:
        if self._off_by(goal, odometry) <= 1.0:
            self.phase = Phase.PARKED
        elif self._attempts >= self._settings.attempts:
            self.phase = Phase.GAVE_UP
        else:
            self._attempts += 1
            self.phase = Phase.APPROACHING
            self._manoeuvre = manoeuvre(odometry.pose, goal, self._settings.rates, start_ns, odometry.frame_id)

    def _off_by(self, goal: Pose2, odometry: Odometry) -> float:
        """The larger of position and heading error, each as a multiple of its tolerance."""
        yaw_error = abs(angle_difference(goal.yaw_rad, odometry.pose.yaw_rad))
        return max(
            _distance(goal, odometry.pose) / self._settings.position_tolerance_m,
            yaw_error / self._settings.yaw_tolerance_rad,
        )

    def _rests(self, odometry: Odometry) -> bool:
        return (
            abs(odometry.twist.speed_mps) <= self._settings.rest_speed_mps
            and abs(odometry.twist.yaw_rate_radps) <= self._settings.rest_yaw_rate_radps
        )

    @staticmethod
    def _is_pushed(way: Trajectory, odometry: Odometry) -> bool:
        states, _ = way.at(odometry.stamp_ns, np.zeros(1))
        expected = Pose2(*(float(value) for value in states[0]))
        turned = abs(angle_difference(expected.yaw_rad, odometry.pose.yaw_rad))
        return _distance(expected, odometry.pose) > PUSHED_M or turned > PUSHED_RAD


def resting_pose(reference: Trajectory, now_ns: int, start_ns: int, horizon_s: float) -> Pose2 | None:
    """The pose at which ``reference`` stands from now to the end of the horizon; None if it moves."""
    ahead_s = seconds_between(start_ns, now_ns) + horizon_s
    states, inputs = reference.at(now_ns, np.linspace(0.0, ahead_s, 21))
    last = states[-1]
    if np.abs(inputs).max() > STILL or np.abs(states[:, :2] - last[:2]).max() > STILL:
        return None
    if np.abs(angle_difference(states[:, 2], float(last[2]))).max() > STILL:
        return None
    return Pose2(float(last[0]), float(last[1]), float(last[2]))


def _standing(odometry: Odometry) -> Trajectory:
    pose = odometry.pose.as_array()[None]
    return Trajectory(odometry.stamp_ns, odometry.frame_id, np.zeros(1), pose, np.zeros((1, 2)))


def _distance(one: Pose2, other: Pose2) -> float:
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)
