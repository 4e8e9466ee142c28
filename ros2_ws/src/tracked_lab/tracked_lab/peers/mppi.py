"""Model predictive path integral control: many disturbed copies of the plan, weighed by how they fare.

Costs are those of the tracking critics of Nav2's controller: distance to the reference along the way and at its end,
heading, driving backwards; velocity limits by clipping. The reference has a time, so distances are to where it is then.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import savgol_filter

from nmpc_layers.drive_limits import DriveLimits
from sim_bridge.compiled import compiled
from tracked_description import Robot
from tracked_lab.peers.control_peer import SHARED, ControlPeer
from tracked_lab.tuning import check_known, tuning_of
from tracked_types import Odometry, Trajectory, Twist2
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class MppiSettings:
    """Sampling, and what is weighed."""

    samples: int = setting(1500, "disturbed copies of the plan", low=10, high=10000)
    steps: int = setting(50, "steps of the plan, one control period each", low=5, high=200)
    speed_deviation_mps: float = setting(0.2, "of the speed's disturbance", unit="m/s", low=0.001, high=2.0)
    yaw_rate_deviation_radps: float = setting(0.4, "of the yaw rate's disturbance", unit="rad/s", low=0.001, high=5.0)
    temperature: float = setting(0.3, "the lower, the more the best copies count", low=1e-4, high=100.0)
    gamma: float = setting(0.015, "weight of staying with the last plan", low=0.0, high=10.0)
    path_align: float = setting(14.0, "per metre from the reference, on average", low=0.0, high=1000.0)
    path_follow: float = setting(5.0, "per metre from the reference at the plan's end", low=0.0, high=1000.0)
    path_angle: float = setting(2.0, "per radian from the reference's heading, on average", low=0.0, high=1000.0)
    prefer_forward: float = setting(5.0, "per m/s backwards, on average", low=0.0, high=1000.0)

    def __post_init__(self) -> None:
        check_settings(self)


class Mppi:
    """Keeps the plan from tick to tick; the disturbances are drawn once, as Nav2 does unless told otherwise."""

    def __init__(self, settings: MppiSettings, limits: DriveLimits, period_s: float, seed: int) -> None:
        self._settings, self._period_s = settings, period_s
        deviations = np.array([settings.speed_deviation_mps, settings.yaw_rate_deviation_radps])
        generator = np.random.default_rng(seed)
        self._noise = deviations * generator.standard_normal((settings.samples, settings.steps, 2))
        self._pull = settings.gamma / deviations**2
        self._low, self._high = np.array(limits.low, float), np.array(limits.high, float)
        self._plan = np.zeros((settings.steps, 2))
        self._critics = np.array(
            [settings.path_align, settings.path_follow, settings.path_angle, settings.prefer_forward]
        )

    def steer(self, odometry: Odometry, reference: Trajectory) -> Twist2:
        """One iteration; its first command."""
        settings = self._settings
        offsets = self._period_s * np.arange(1.0, settings.steps + 1.0)
        states, _ = reference.at(odometry.stamp_ns, offsets)
        costs = np.empty(settings.samples)
        start = odometry.pose.as_array()
        roll_out(
            start,
            self._plan,
            self._noise,
            states,
            self._low,
            self._high,
            self._period_s,
            self._critics,
            self._pull,
            costs,
        )
        weights = np.exp((costs.min() - costs) / settings.temperature)
        change = np.tensordot(weights / weights.sum(), self._noise, axes=1)
        plan = savgol_filter(np.clip(self._plan + change, self._low, self._high), 9, 2, axis=0)
        plan = np.clip(plan, self._low, self._high)
        self._plan = np.vstack([plan[1:], plan[-1:]])
        return Twist2(float(plan[0, 0]), float(plan[0, 1]))


@compiled
def roll_out(
    start: Any,
    plan: Any,
    noise: Any,
    reference: Any,
    low: Any,
    high: Any,
    period_s: float,
    critics: Any,
    pull: Any,
    costs: Any,
) -> None:
    """Cost of every disturbed copy of the plan (steps, 2), into ``costs`` (samples,)."""
    samples, steps = noise.shape[0], noise.shape[1]
    align, follow, angle, forward = critics[0], critics[1], critics[2], critics[3]
    for sample in range(samples):
        x, y, yaw, total, distance = start[0], start[1], start[2], 0.0, 0.0
        for step in range(steps):
            speed = min(max(plan[step, 0] + noise[sample, step, 0], low[0]), high[0])
            rate = min(max(plan[step, 1] + noise[sample, step, 1], low[1]), high[1])
            middle = yaw + 0.5 * period_s * rate
            x += period_s * speed * math.cos(middle)
            y += period_s * speed * math.sin(middle)
            yaw += period_s * rate
            distance = math.hypot(x - reference[step, 0], y - reference[step, 1])
            turn = yaw - reference[step, 2]
            turn -= 2.0 * math.pi * math.floor((turn + math.pi) / (2.0 * math.pi))
            total += (align * distance + angle * abs(turn) - forward * min(speed, 0.0)) / steps
            total += pull[0] * plan[step, 0] * noise[sample, step, 0] + pull[1] * plan[step, 1] * noise[sample, step, 1]
        costs[sample] = total + follow * distance


def mppi(robot: Robot, parameters: Mapping[str, Any]) -> ControlPeer:
    """MPPI at the control rate."""
    check_known("mppi", parameters, (MppiSettings,), *SHARED)
    settings = MppiSettings(**tuning_of(MppiSettings, parameters))
    law = Mppi(settings, DriveLimits.from_robot(robot), 1.0 / robot.control.rate_hz, parameters.get("seed", 0))
    return ControlPeer(law, robot, parameters["pipeline_latency_s"])
