"""Does the robot stand?"""

import math
from collections import deque

from tracked_localization.belt_pair import BeltMotion
from tracked_localization.settings import OdometryFilterSettings
from tracked_types import to_nanoseconds

_LEAVING_SAMPLES = 8
_LEAVING_DEVIATIONS = 6.0
_QUIET_SPREAD = 1.5
_DRIFT_DEVIATIONS = 3.0
_SWAY_RADPS = 0.06
_SWAY_S = 1.5
_LEAST_NOISE = 1e-4


class Standstill:
    """The robot stands when its belts have not counted and its gyro has been no more than noisy for a while.

    A steady gyro reading at rest is bias, whatever its size: a body that slides on slows down. It stops
    standing with the first belt motion beyond one tick, or when the gyro's mean leaves the bias.
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._noise = max(settings.gyro_noise_radps, _LEAST_NOISE)
        self._window = max(4, round(settings.standstill_s * settings.imu_rate_hz))
        self._standstill_ns = to_nanoseconds(settings.standstill_s)
        self._long_window = self._window + self._window // 2
        self._sway_window = max(self._long_window, round(_SWAY_S * settings.imu_rate_hz))
        self._silence_ns = to_nanoseconds(settings.silence_s)
        self._rates: deque[float] = deque(maxlen=self._sway_window)
        self.restart()

    def restart(self) -> None:
        """Nothing is known any more."""
        self._rates.clear()
        self._still_since_ns: int | None = None
        self._belts_ns = 0
        self._left_m = self._right_m = 0.0
        self.standing = False
        self.new_bias_radps: float | None = None
        """Mean gyro reading, if the robot was just found standing and it is not the bias we knew."""

    def add_belts(self, motion: BeltMotion) -> None:
        """Take in what the belts did."""
        self._belts_ns = motion.stamp_ns
        if motion.left_m is None or motion.right_m is None:
            self._move(None)
            return
        if self._still_since_ns is None:
            self._move(motion.stamp_ns)
            return
        self._left_m += motion.left_m
        self._right_m += motion.right_m
        if max(abs(self._left_m), abs(self._right_m)) > 1.5 * self._settings.encoder_tick_m:
            self._move(motion.stamp_ns)

    def add_gyro(self, stamp_ns: int, rate_radps: float | None, bias_radps: float, bias_variance: float) -> None:
        """Take in a gyro reading, or None for one that cannot be trusted: then the belts alone decide."""
        self.new_bias_radps = None
        if rate_radps is None:
            self._rates.clear()
        else:
            self._rates.append(rate_radps)
        if stamp_ns - self._belts_ns > self._silence_ns:
            self._move(None)
        if self.standing:
            self.standing = not self._leaves(bias_radps)
        elif self._still_since_ns is not None and stamp_ns - self._still_since_ns >= self._standstill_ns:
            self._settle(rate_radps is not None, bias_radps, bias_variance)

    def _settle(self, gyro_speaks: bool, bias_radps: float, bias_variance: float) -> None:
        if not gyro_speaks:
            self.standing = True
            return
        if len(self._rates) < self._window:
            return
        mean = self._quiet_mean(self._window)
        if mean is None:
            return
        expected = bias_variance + self._noise**2 / 4.0
        deviation = abs(mean - bias_radps)
        if deviation * deviation > self._settings.gate_chi_square * expected:
            # Not the bias we know, or a body that still sways on its belts: slower, and by less.
            mean = self._quiet_mean(self._long_window if deviation > _SWAY_RADPS else self._sway_window)
            if mean is None:
                return
            self.new_bias_radps = mean
        self.standing = True

    def _quiet_mean(self, length: int) -> float | None:
        """Mean of the last ``length`` readings if they show noise and nothing else."""
        if len(self._rates) < length:
            return None
        latest = list(self._rates)[-length:]
        half = length // 2
        drift = (math.fsum(latest[half : 2 * half]) - math.fsum(latest[:half])) / half
        if abs(drift) > _DRIFT_DEVIATIONS * self._noise * math.sqrt(2.0 / half):
            return None
        mean = math.fsum(latest) / length
        spread = math.fsum((rate - mean) ** 2 for rate in latest) / length
        return mean if spread <= (_QUIET_SPREAD * self._noise) ** 2 else None

    def _leaves(self, bias_radps: float) -> bool:
        if len(self._rates) < _LEAVING_SAMPLES:
            return False
        latest = [self._rates[-index] for index in range(1, _LEAVING_SAMPLES + 1)]
        deviation = math.fsum(latest) / _LEAVING_SAMPLES - bias_radps
        return abs(deviation) > _LEAVING_DEVIATIONS * self._noise / math.sqrt(_LEAVING_SAMPLES)

    def _move(self, stamp_ns: int | None) -> None:
        self._still_since_ns = stamp_ns
        self._left_m = self._right_m = 0.0
        self.standing = False
