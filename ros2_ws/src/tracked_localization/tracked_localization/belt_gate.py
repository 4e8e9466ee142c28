"""Is what one belt's counter says possible?"""

import math
from dataclasses import dataclass

from tracked_localization.health import Fault
from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.suspicion import Suspicion
from tracked_types import seconds_between


@dataclass(frozen=True, slots=True)
class BeltReading:
    """Travel of one belt since its counter's last sample, None if it is not to be used, and the fault if any."""

    travel_m: float | None
    fault: Fault | None = None


class BeltGate:
    """Chi-square gate on the counter of one belt.

    A belt cannot change its speed faster than its drive allows. The prediction is its last credible
    speed, with a variance that grows with the time since then. A belt that seems to stop dead is a counter
    that is stuck, and stays so until it counts again.
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._rounding = settings.encoder_tick_m**2 / 6.0
        self.restart()

    def restart(self) -> None:
        """Forget counter and speed."""
        self._last_m: float | None = None
        self._last_ns = 0
        self._speed_mps = 0.0
        self._credible_ns: int | None = None
        self._still = 0
        self._stuck = False
        self._suspicion = Suspicion()

    def update(self, stamp_ns: int, travel_m: float) -> BeltReading:
        """Judge the counter's next value."""
        if not math.isfinite(travel_m):
            return BeltReading(None, Fault.NOT_FINITE)
        if self._last_m is None:
            self._last_m, self._last_ns = travel_m, stamp_ns
            return BeltReading(None)
        moved, duration = travel_m - self._last_m, seconds_between(stamp_ns, self._last_ns)
        self._last_m, self._last_ns = travel_m, stamp_ns
        still = abs(moved) < 0.5 * self._settings.encoder_tick_m
        self._still = self._still + 1 if still else 0
        if self._stuck:
            self._stuck = still
            # The first count after a pause may hold the travel of the pause: not credible yet either way.
            return BeltReading(None, Fault.STUCK)
        excess = self._excess(moved, duration, stamp_ns)
        if excess <= 1.0:
            self._speed_mps, self._credible_ns = moved / duration, stamp_ns
            return BeltReading(moved)
        to_blame = self._suspicion.refused(stamp_ns, excess)
        if still:
            self._stuck = True
            return BeltReading(None, Fault.STUCK if to_blame else None)
        return BeltReading(None, Fault.JUMP if to_blame else None)

    def declare_stuck(self) -> None:
        """Another witness says that this belt moves."""
        self._stuck = True

    @property
    def still_samples(self) -> int:
        """Number of samples in a row that were identical."""
        return self._still

    def _excess(self, moved: float, duration: float, stamp_ns: int) -> float:
        """Squared surprise in units of the gate; beyond 1 it is refused."""
        settings = self._settings
        if abs(moved) > 2.0 * settings.belt_speed_limit_mps * duration + 2.0 * settings.encoder_tick_m:
            return math.inf
        if self._credible_ns is None:
            return 0.0
        age = seconds_between(stamp_ns, self._credible_ns)
        manoeuvre = 0.5 * settings.belt_acceleration_mps2 * age * duration
        surprise = moved - self._speed_mps * duration
        variance = 2.0 * self._rounding + manoeuvre * manoeuvre
        return surprise * surprise / (settings.gate_chi_square * variance)
