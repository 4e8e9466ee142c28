"""Both belts together: travel of each, forward travel, and a stuck counter that only the pair betrays."""

from dataclasses import dataclass

from tracked_localization.belt_gate import BeltGate, BeltReading
from tracked_localization.health import LEFT_TRACK, RIGHT_TRACK, Fault
from tracked_localization.settings import OdometryFilterSettings
from tracked_types import TrackSample, seconds_between

_CROSS_CHECK_S = 0.35
_CROSS_CHECK_SPEED_MPS = 0.1
_LEAST_YAW_SHARE = 0.3


@dataclass(frozen=True, slots=True)
class BeltMotion:
    """Travel of the belts (m) since the previous sample, ``duration_s`` ago; None where it is not credible."""

    stamp_ns: int
    duration_s: float
    left_m: float | None
    right_m: float | None
    faults: tuple[tuple[str, Fault], ...]

    def yaw_rate_radps(self, gauge_m: float) -> float | None:
        """Mean yaw rate that the belts ask for."""
        if self.left_m is None or self.right_m is None:
            return None
        return (self.right_m - self.left_m) / (gauge_m * self.duration_s)


class BeltPair:
    """Judges both counters and cross-checks them against the gyro.

    A counter that got stuck at rest shows no jump. If one belt counts nothing at all while the other
    runs, the body must pivot; if the gyro does not see it turn, the silent counter is stuck.
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._left = BeltGate(settings)
        self._right = BeltGate(settings)
        self.restart()

    def restart(self) -> None:
        """Forget both counters."""
        self._left.restart()
        self._right.restart()
        self._last_ns: int | None = None
        self._pivot_m = 0.0
        self._pivot_s = 0.0
        self._turned_rad = 0.0

    def update(self, sample: TrackSample, yaw_rate_radps: float | None) -> BeltMotion:
        """Judge one sample; ``yaw_rate_radps`` is the gyro's mean rate since the last one, if it is known."""
        left = self._left.update(sample.stamp_ns, sample.left_travel_m)
        right = self._right.update(sample.stamp_ns, sample.right_travel_m)
        duration = seconds_between(sample.stamp_ns, self._last_ns) if self._last_ns is not None else 0.0
        self._last_ns = sample.stamp_ns
        left, right = self._cross_check(left, right, duration, yaw_rate_radps)
        faults = ((LEFT_TRACK, left.fault), (RIGHT_TRACK, right.fault))
        return BeltMotion(
            stamp_ns=sample.stamp_ns,
            duration_s=duration,
            left_m=left.travel_m,
            right_m=right.travel_m,
            faults=tuple((sensor, fault) for sensor, fault in faults if fault is not None),
        )

    def _cross_check(
        self, left: BeltReading, right: BeltReading, duration: float, yaw_rate: float | None
    ) -> tuple[BeltReading, BeltReading]:
        one_still = (self._left.still_samples > 0) != (self._right.still_samples > 0)
        if left.travel_m is None or right.travel_m is None or yaw_rate is None or not one_still:
            self._pivot_m = self._pivot_s = self._turned_rad = 0.0
            return left, right
        self._pivot_m += right.travel_m - left.travel_m
        self._pivot_s += duration
        self._turned_rad += yaw_rate * duration
        if self._pivot_s < _CROSS_CHECK_S or abs(self._pivot_m) < _CROSS_CHECK_SPEED_MPS * self._pivot_s:
            return left, right
        if self._turned_rad * self._settings.gauge_m / self._pivot_m >= _LEAST_YAW_SHARE:
            return left, right
        stuck = BeltReading(None, Fault.STUCK)
        if self._left.still_samples > 0:
            self._left.declare_stuck()
            return stuck, right
        self._right.declare_stuck()
        return left, stuck
