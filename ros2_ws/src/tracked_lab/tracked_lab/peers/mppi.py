"""Model predictive path integral control: many disturbed copies of the plan, weighed by how they fare.

After Nav2's controller (nav2_mppi_controller): its critics for tracking, its state predicted over one control period,
its acceleration limits in the roll-out, its smoothing of the plan with the commands before it, its disturbances drawn
once. What it does not know, and is judged by here, is time: so its critics measure the distance to where the reference
is at that moment, instead of to the nearest part of a path.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs

from nmpc_layers.drive_limits import DriveLimits
from tracked_description import Robot
from tracked_lab.peers.control_peer import SHARED, ControlPeer
from tracked_lab.peers.path_integral import KNOTS, as_seen_from, roll_out
from tracked_lab.tuning import check_known, tuning_of
from tracked_types import Odometry, Pose2, Trajectory, Twist2
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]
_SMOOTHING = savgol_coeffs(2 * KNOTS + 1, 2)


@dataclass(frozen=True, slots=True, kw_only=True)
class MppiSettings:
    """Sampling, and what is weighed; the defaults are those of the example in Nav2's README, at 30 Hz."""

    samples: int = setting(2000, "disturbed copies of the plan", low=10, high=10000)
    steps: int = setting(50, "steps of the plan, one control period each", low=5, high=200)
    speed_deviation_mps: float = setting(0.2, "of the speed's disturbance", unit="m/s", low=0.001, high=2.0)
    yaw_rate_deviation_radps: float = setting(0.4, "of the yaw rate's disturbance", unit="rad/s", low=0.001, high=5.0)
    temperature: float = setting(0.3, "the lower, the more the best copies count", low=1e-4, high=100.0)
    gamma: float = setting(0.015, "weight of staying with the last plan", low=0.0, high=10.0)
    path_align: float = setting(14.0, "per metre from the reference, on average", low=0.0, high=1000.0)
    path_follow: float = setting(5.0, "per metre from the reference at the plan's end", low=0.0, high=1000.0)
    path_angle: float = setting(2.0, "per radian from the reference's heading, on average", low=0.0, high=1000.0)
    goal: float = setting(5.0, "per metre from where the reference rests at the plan's end", low=0.0, high=1000.0)
    goal_angle: float = setting(3.0, "per radian from the heading in which it rests there", low=0.0, high=1000.0)
    constraint: float = setting(4.0, "per m/s or rad/s beyond the limits, on average", low=0.0, high=1000.0)
    prefer_forward: float = setting(5.0, "per m/s backwards, on average", low=0.0, high=1000.0)

    def __post_init__(self) -> None:
        check_settings(self)


class Mppi:
    """Keeps the plan from tick to tick, and the commands that it has given.

    Parameters
    ----------
    limits: of speed and yaw rate, and of their change.
    period_s: between two commands, and of a step.
    seed: of the disturbances, which are the same at every tick, as Nav2's are unless told otherwise.
    """

    def __init__(self, settings: MppiSettings, limits: DriveLimits, period_s: float, seed: int) -> None:
        self._settings, self._period_s = settings, period_s
        deviations = np.array([settings.speed_deviation_mps, settings.yaw_rate_deviation_radps])
        generator = np.random.default_rng(seed)
        self._noise = deviations * generator.standard_normal((settings.samples, settings.steps, 2))
        self._pull = settings.gamma / deviations**2
        self._low, self._high = np.array(limits.low, float), np.array(limits.high, float)
        self._change = period_s * np.array([limits.acceleration_mps2, limits.yaw_acceleration_radps2])
        self._plan = np.zeros((settings.steps, 2))
        self._given = np.zeros((KNOTS, 2))
        self._offsets = period_s * np.arange(2.0, settings.steps + 2.0)
        self._costs = np.empty(settings.samples)

    def steer(self, odometry: Odometry, reference: Trajectory) -> Twist2:
        """One iteration; its first command."""
        measured = np.array([odometry.twist.speed_mps, odometry.twist.yaw_rate_radps])
        start = _after(odometry.pose, *(self._period_s * measured).tolist())
        states, inputs = reference.at(odometry.stamp_ns, self._offsets)
        before = np.clip(self._given[-1], measured - self._change, measured + self._change)
        roll_out(
            self._plan,
            self._noise,
            as_seen_from(start, states),
            before,
            (self._low, self._high, self._change),
            self._period_s,
            self._critics(rests=not inputs[-1].any()),
            self._pull,
            self._costs,
        )
        weights = np.exp((self._costs.min() - self._costs) / self._settings.temperature)
        plan = self._plan + np.tensordot(weights / weights.sum(), self._noise, axes=1)
        plan = self._smoothed(np.clip(plan, self._low, self._high))
        self._plan = np.vstack([plan[1:], plan[-1:]])
        self._given = np.vstack([self._given[1:], plan[:1]])
        return Twist2(*plan[0].tolist())

    def _smoothed(self, plan: Array) -> Array:
        """Savitzky-Golay, as if the plan had begun with the last commands and went on as it ends."""
        longer = np.vstack([self._given, plan, np.repeat(plan[-1:], KNOTS, axis=0)])
        return np.column_stack([np.convolve(column, _SMOOTHING, mode="valid") for column in longer.T])

    def _critics(self, *, rests: bool) -> Array:
        settings = self._settings
        goal = (settings.goal, settings.goal_angle) if rests else (0.0, 0.0)
        along = (settings.path_align, settings.path_angle, settings.constraint, settings.prefer_forward)
        return np.array([*along, settings.path_follow + goal[0], goal[1]])


def _after(pose: Pose2, way_m: float, turn_rad: float) -> Pose2:
    """Where an arc leads."""
    return pose.compose(Pose2(way_m * math.cos(0.5 * turn_rad), way_m * math.sin(0.5 * turn_rad), turn_rad))


def mppi(robot: Robot, parameters: Mapping[str, Any]) -> ControlPeer:
    """MPPI at the control rate."""
    check_known("mppi", parameters, (MppiSettings,), *SHARED)
    settings = MppiSettings(**tuning_of(MppiSettings, parameters))
    law = Mppi(settings, DriveLimits.from_robot(robot), 1.0 / robot.control.rate_hz, parameters.get("seed", 0))
    return ControlPeer(law, robot, parameters["pipeline_latency_s"])
