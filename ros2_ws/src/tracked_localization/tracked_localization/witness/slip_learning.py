"""What belts, gyro and scan steps teach: the lost share, the yaw multiplier, the gyro's bias."""

import math

import numpy as np
from numpy.typing import NDArray

from tracked_localization.witness.settings import WitnessSettings
from tracked_localization.witness.walking_value import WalkingValue
from tracked_types import Pose2, seconds_between

Array = NDArray[np.float64]
_HEADING_SEEN_RAD = 0.01
_SHARE_SEEN = 0.2


class SlipLearning:
    """Three slowly changing numbers, each with a variance that grows where nobody sees it.

    share: of the belts' travel that the ground takes. multiplier: yaw rate over ground per yaw rate of the belts.
    bias_radps: of the gyro.
    """

    def __init__(self, settings: WitnessSettings) -> None:
        self._settings = settings
        spread = settings.share_deviation**2
        self.share = WalkingValue(0.0, spread, settings.share_walk_sqrt_s, spread)
        spread = settings.multiplier_deviation**2
        self.multiplier = WalkingValue(
            settings.yaw_multiplier, spread, settings.multiplier_walk_sqrt_s, settings.multiplier_deviation**2
        )
        spread = settings.initial_bias_deviation_radps**2
        self.bias = WalkingValue(0.0, spread, settings.bias_walk_radps_sqrt_s, spread)
        self._lost_by_scan: tuple[int, float] | None = None
        self._turn_by_scan: tuple[int, float] | None = None

    def pass_time(self, duration_s: float) -> None:
        """Let time pass."""
        for value in (self.share, self.multiplier, self.bias):
            value.pass_time(duration_s)

    def lost_by_scan(self, now_ns: int) -> float | None:
        """Share of the belts' travel that the latest scan step missed; None if it is old or does not show it."""
        return self._fresh(self._lost_by_scan, now_ns)

    def turn_by_scan(self, now_ns: int) -> float | None:
        """Share of the belts' turn that the latest scan step saw; None likewise."""
        return self._fresh(self._turn_by_scan, now_ns)

    def yaw_variance(self, duration_s: float) -> float:
        """Variance of the gyro's mean rate less the belts' over one period, (rad/s)^2."""
        rounding = self._settings.encoder_tick_m**2 / (3.0 * (self._settings.gauge_m * duration_s) ** 2)
        return self._gyro_variance(duration_s) + self.bias.variance + rounding

    def motion_covariance(self, motion: Pose2, belt_travel_m: float, duration_s: float) -> Array:
        """Covariance (3, 3) of a motion between two scans as belts and gyro have it."""
        along = self.share.variance * (motion.x_m**2 + belt_travel_m**2)
        across = (self._settings.sideways_deviation_m * motion.yaw_rad) ** 2
        heading = (self._gyro_variance(duration_s) + self.bias.variance) * duration_s**2 if duration_s else 0.0
        return np.diag([along + 1e-8, across + 1e-8, heading + 1e-10])

    def learn_turn(self, turn_rad: float, asked_rad: float, duration_s: float) -> None:
        """The gyro's turn, its bias taken out, over one period of belts that ask for ``asked_rad``."""
        rate = asked_rad / duration_s
        if abs(rate) > self._settings.least_belt_yaw_rate_radps:
            self.multiplier.measure(turn_rad / asked_rad, self.yaw_variance(duration_s) / rate**2)

    def learn_step(
        self,
        now_ns: int,
        duration_s: float,
        step: Pose2,
        covariance: Array,
        belts: Array | None,
        gyro_rad: float | None,
    ) -> None:
        """The motion between two scans, the belts' (travel in m, turn in rad) and the gyro's turn in the meantime."""
        settings, heading_variance = self._settings, float(covariance[2, 2])
        heading_seen = heading_variance < _HEADING_SEEN_RAD**2
        if gyro_rad is not None and heading_seen:
            noise = heading_variance / duration_s**2 + self._gyro_variance(duration_s)
            self.bias.measure((gyro_rad - step.yaw_rad) / duration_s, noise)
        if belts is None:
            return
        travel, asked = float(belts[0]), float(belts[1])
        if heading_seen and abs(asked) > settings.least_belt_yaw_rate_radps * duration_s:
            self._turn_by_scan = (now_ns, step.yaw_rad / asked)
        if abs(travel) < settings.least_belt_speed_mps * duration_s:
            return
        along, variance = _arc_length(step, covariance)
        lost, noise = 1.0 - along / travel, variance / travel**2
        self.share.measure(lost, noise)
        self._lost_by_scan = (now_ns, lost) if noise < _SHARE_SEEN**2 else None

    def _gyro_variance(self, duration_s: float) -> float:
        """Of the mean of its samples, bias apart."""
        return self._settings.gyro_noise_radps**2 * self._settings.imu_period_s / duration_s

    def _fresh(self, said: tuple[int, float] | None, now_ns: int) -> float | None:
        if said is None or seconds_between(now_ns, said[0]) > self._settings.scan_silence_s:
            return None
        return said[1]


def _arc_length(step: Pose2, covariance: Array) -> tuple[float, float]:
    """Way ahead along the arc of a step, and its variance."""
    half = 0.5 * step.yaw_rad
    direction = np.array([math.cos(half), math.sin(half)])
    chord = float(direction @ [step.x_m, step.y_m])
    bend = math.sin(half) / half if abs(half) > 1e-6 else 1.0
    return chord / max(bend, 0.1), float(direction @ covariance[:2, :2] @ direction)
