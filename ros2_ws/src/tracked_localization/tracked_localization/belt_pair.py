"""Both belts together: travel of each, forward travel, and a stuck counter that only the pair betrays."""

from dataclasses import dataclass

from tracked_localization.belt_gate import BeltGate, BeltReading
from tracked_localization.health import Fault
from tracked_localization.settings import OdometryFilterSettings
from tracked_types import LEFT_TRACK, RIGHT_TRACK, TrackSample, seconds_between

_CHECK_S = 0.35
_LEAST_SPEED_MPS = 0.1
_LEAST_YAW_SHARE = 0.3
_REST_RATE_RADPS = 0.25


@dataclass(frozen=True, slots=True)
class BeltMotion:
    """Travel of the belts (m) since the previous sample, ``duration_s`` ago; None where it is not credible."""

    stamp_ns: int
    duration_s: float
    left_m: float | None
    right_m: float | None
    faults: tuple[tuple[str, Fault], ...]

    def turn_rad(self, gauge_m: float) -> float:
        """Turn that the belts ask for; zero if they are not both credible."""
        if self.left_m is None or self.right_m is None:
            return 0.0
        return (self.right_m - self.left_m) / gauge_m


@dataclass(slots=True)
class _Check:
    """Difference of the belts' travel and turn of the body while the same counters (left, right) stood still."""

    still: tuple[bool, bool] = (False, False)
    difference_m: float = 0.0
    duration_s: float = 0.0
    turned_rad: float = 0.0


class BeltPair:
    """Judges both counters and cross-checks them against the gyro.

    A counter that got stuck at rest shows no jump. If one belt counts nothing at all while the other runs,
    or neither does, and the gyro does not turn as that would have it, the silent counters are stuck.
    (Both stuck at rest and then straight on is the one case that no turn betrays.)
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._left = BeltGate(settings)
        self._right = BeltGate(settings)
        self._last_ns: int | None = None
        self._check = _Check()

    def restart(self) -> None:
        """Forget both counters."""
        self._left.restart()
        self._right.restart()
        self._last_ns = None
        self._check = _Check()

    def update(self, sample: TrackSample, yaw_rate_radps: float | None) -> BeltMotion:
        """Judge one sample; ``yaw_rate_radps`` is the gyro's mean rate since the last one, if it is known."""
        left = self._left.update(sample.stamp_ns, sample.left_travel_m)
        right = self._right.update(sample.stamp_ns, sample.right_travel_m)
        duration = seconds_between(sample.stamp_ns, self._last_ns) if self._last_ns is not None else 0.0
        self._last_ns = sample.stamp_ns
        if self._contradicted(left, right, duration, yaw_rate_radps):
            left, right = _still_is_stuck(left, self._left), _still_is_stuck(right, self._right)
        faults = ((LEFT_TRACK, left.fault), (RIGHT_TRACK, right.fault))
        return BeltMotion(
            stamp_ns=sample.stamp_ns,
            duration_s=duration,
            left_m=left.travel_m,
            right_m=right.travel_m,
            faults=tuple((sensor, fault) for sensor, fault in faults if fault is not None),
        )

    def _contradicted(self, left: BeltReading, right: BeltReading, duration: float, yaw_rate: float | None) -> bool:
        """Whether the gyro has contradicted motionless counters for long enough."""
        still = (self._left.still_samples > 0, self._right.still_samples > 0)
        if left.travel_m is None or right.travel_m is None or yaw_rate is None or not any(still):
            self._check = _Check()
            return False
        if still != self._check.still:
            self._check = _Check(still)
        check = self._check
        check.difference_m += right.travel_m - left.travel_m
        check.duration_s += duration
        check.turned_rad += yaw_rate * duration
        if check.duration_s < _CHECK_S:
            return False
        if all(still):
            return abs(check.turned_rad) > _REST_RATE_RADPS * check.duration_s
        if abs(check.difference_m) < _LEAST_SPEED_MPS * check.duration_s:
            return False
        return check.turned_rad * self._settings.gauge_m / check.difference_m < _LEAST_YAW_SHARE


def _still_is_stuck(reading: BeltReading, gate: BeltGate) -> BeltReading:
    if gate.still_samples == 0:
        return reading
    gate.declare_stuck()
    return BeltReading(None, Fault.STUCK)
