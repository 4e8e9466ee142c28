"""Is what the gyro says possible?"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_localization.health import Fault
from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.suspicion import Suspicion
from tracked_types import ImuSample, seconds_between

_RANGE = 5.0
_PROBATION_SAMPLES = 12
_LONGEST_MEMORY_S = 1.0


@dataclass(frozen=True, slots=True)
class GyroReading:
    """Yaw rate as the gyro gives it, bias included, None if it is not to be used, and the fault if any."""

    rate_radps: float | None
    fault: Fault | None = None


class GyroGate:
    """Chi-square gate on the yaw rate.

    The body cannot change its yaw rate faster than tracks allow, and noise never repeats itself. After a
    jump the gyro must agree roughly with the belts for a while before it is trusted again: the belts'
    yaw rate is wrong by a fifth or more, but not by a radian per second.
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._axis = np.array(settings.imu_up_axis)
        self._watch_repetition = settings.stuck_samples > 0 and settings.gyro_noise_radps > 0.0
        self.restart()

    def restart(self) -> None:
        """Forget the past."""
        self._last: NDArray[np.float64] | None = None
        self._repeated = 0
        self._credible_ns: int | None = None
        self._probation = 0
        self._suspicion = Suspicion()

    def update(
        self, sample: ImuSample, expected_radps: float, variance: float, belt_yaw_rate_radps: float | None
    ) -> GyroReading:
        """Judge a sample against the reading expected, whose variance leaves out sudden manoeuvres.

        ``belt_yaw_rate_radps``: what the belts ask for, or None if they are not credible now.
        """
        if not (
            np.isfinite(sample.angular_velocity_radps).all() and np.isfinite(sample.linear_acceleration_mps2).all()
        ):
            return GyroReading(None, Fault.NOT_FINITE)
        rate = float(self._axis @ sample.angular_velocity_radps)
        if self._repeats(sample.angular_velocity_radps):
            return GyroReading(None, Fault.STUCK)
        if abs(rate) > _RANGE * self._settings.yaw_rate_limit_radps:
            return self._refuse(Fault.IMPLAUSIBLE)
        surprise = rate - expected_radps
        gate = self._settings.gate_chi_square * (variance + self._manoeuvre(sample.stamp_ns))
        if surprise * surprise > gate:
            to_blame = self._suspicion.refused(sample.stamp_ns, surprise * surprise / gate)
            return self._refuse(Fault.JUMP) if to_blame else GyroReading(None)
        if self._probation and belt_yaw_rate_radps is not None:
            if not self._agrees(rate, belt_yaw_rate_radps):
                return self._refuse(Fault.JUMP)
            self._probation -= 1
            return GyroReading(None)
        self._probation = 0
        self._credible_ns = sample.stamp_ns
        return GyroReading(rate)

    def _refuse(self, fault: Fault) -> GyroReading:
        self._probation = _PROBATION_SAMPLES
        return GyroReading(None, fault)

    def _manoeuvre(self, stamp_ns: int) -> float:
        if self._credible_ns is None:
            return self._settings.yaw_rate_limit_radps**2
        age = min(seconds_between(stamp_ns, self._credible_ns), _LONGEST_MEMORY_S)
        return (0.5 * self._settings.body_yaw_acceleration_radps2 * age) ** 2

    def _agrees(self, rate: float, belts: float) -> bool:
        share = self._settings.belt_yaw_ratio
        return abs(rate - share * belts) <= 0.4 + 0.5 * abs(belts)

    def _repeats(self, angular_velocity: NDArray[np.float64]) -> bool:
        if self._last is not None and np.array_equal(self._last, angular_velocity):
            self._repeated += 1
        else:
            self._repeated = 0
        self._last = angular_velocity
        return self._watch_repetition and self._repeated + 1 >= self._settings.stuck_samples
