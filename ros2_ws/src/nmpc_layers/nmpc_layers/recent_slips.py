"""The slip estimates of the last moments, by stamp."""

import math
from collections import deque

from tracked_types import Slip, seconds_between

KEPT = 16  # while a tick waits for its plan; lock-step lets time run on by three at most


class RecentSlips:
    """Slip estimates as they come; a tick uses that of its own instant, however late it ticks."""

    def __init__(self) -> None:
        self._slips: deque[Slip] = deque(maxlen=KEPT)

    def add(self, slip: Slip) -> None:
        """Take one in; one that is not finite is ignored and then counts as missing."""
        if all(map(math.isfinite, (slip.speed_mps, slip.yaw_rate_radps, slip.slide_s))):
            self._slips.append(slip)

    def forget(self) -> None:
        """Drop all."""
        self._slips.clear()

    def lacks(self, stamp_ns: int) -> bool:
        """Whether there are some, but none as new as ``stamp_ns``."""
        return bool(self._slips) and self._slips[-1].stamp_ns < stamp_ns

    def at(self, stamp_ns: int, timeout_s: float) -> tuple[Slip | None, str]:
        """The newest that is no newer than ``stamp_ns``; None if it is off by more than the timeout, and why."""
        if not self._slips:
            return None, "no slip estimate yet: not compensated"
        slip = next((slip for slip in reversed(self._slips) if slip.stamp_ns <= stamp_ns), self._slips[-1])
        age_s = seconds_between(stamp_ns, slip.stamp_ns)
        if abs(age_s) > timeout_s:
            return None, f"slip estimate is {abs(age_s):.2f} s off: not compensated"
        return slip, ""
