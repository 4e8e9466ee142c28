"""Is what the gyro says possible?"""

import math
from dataclasses import dataclass

from tracked_localization.health import Fault
from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.suspicion import Suspicion
from tracked_types import ImuSample, seconds_between

_RANGE = 5.0
_PROBATION_SAMPLES = 12
_LONGEST_MEMORY_S = 1.0
_SHOCK_MPS2 = 6.0
_SHAKING_S = 0.05


@dataclass(frozen=True, slots=True)
class GyroReading:
    """Yaw rate as the gyro gives it, bias included, None if it is not to be used, and the fault if any."""

    rate_radps: float | None
    fault: Fault | None = None


class GyroGate:
    """Chi-square gate on the yaw rate.

    The body cannot change its yaw rate faster than tracks allow, and noise never repeats itself. After a
    jump the gyro must agree roughly with the belts for a while before it is trusted again: the belts'
    yaw rate is wrong by a fifth or more, but not by a radian per second. While the accelerometer feels a
    blow from the side or from ahead, any turn is believed.
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._watch_repetition = settings.stuck_samples > 0 and settings.gyro_noise_radps > 0.0
        self.restart()

    def restart(self) -> None:
        """Forget the past."""
        self._last: list[float] | None = None
        self._repeated = 0
        self._credible_ns: int | None = None
        self._probation = 0
        self._suspicion = Suspicion()
        self._shock_ns: int | None = None

    def update(
        self, sample: ImuSample, expected_radps: float, variance: float, belt_yaw_rate_radps: float | None
    ) -> GyroReading:
        """Judge a sample against the reading expected, whose variance leaves out sudden manoeuvres.

        ``belt_yaw_rate_radps``: what the belts ask for, or None if they are not credible now.
        """
        rates, acceleration = sample.angular_velocity_radps.tolist(), sample.linear_acceleration_mps2.tolist()
        if not all(map(math.isfinite, (*rates, *acceleration))):
            return GyroReading(None, Fault.NOT_FINITE)
        if self._repeats(rates):
            return GyroReading(None, Fault.STUCK)
        rate = self._upward(rates)
        if abs(rate) > _RANGE * self._settings.yaw_rate_limit_radps:
            return self._refuse(Fault.IMPLAUSIBLE)
        surprise = rate - expected_radps
        shaken = self._shaken(acceleration, sample.stamp_ns)
        gate = self._settings.gate_chi_square * (variance + self._manoeuvre(sample.stamp_ns))
        if surprise * surprise > gate and not shaken:
            to_blame = self._suspicion.refused(sample.stamp_ns, surprise * surprise / gate)
            return self._refuse(Fault.JUMP) if to_blame else GyroReading(None)
        if self._probation and belt_yaw_rate_radps is not None and not shaken:
            if not self._agrees(rate, belt_yaw_rate_radps):
                return self._refuse(Fault.JUMP)
            self._probation -= 1
            return GyroReading(None)
        self._probation = 0
        self._credible_ns = sample.stamp_ns
        return GyroReading(rate)

    def _upward(self, vector: list[float]) -> float:
        return sum(along * value for along, value in zip(self._settings.imu_up_axis, vector, strict=True))

    def _shaken(self, acceleration: list[float], stamp_ns: int) -> bool:
        """Whether the body was hit just now: then the yaw rate may do what no track can make it do."""
        upward = self._upward(acceleration)
        if sum(value * value for value in acceleration) - upward * upward > _SHOCK_MPS2 * _SHOCK_MPS2:
            self._shock_ns = stamp_ns
        return self._shock_ns is not None and seconds_between(stamp_ns, self._shock_ns) <= _SHAKING_S

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

    def _repeats(self, rates: list[float]) -> bool:
        self._repeated = self._repeated + 1 if rates == self._last else 0
        self._last = rates
        return self._watch_repetition and self._repeated + 1 >= self._settings.stuck_samples
