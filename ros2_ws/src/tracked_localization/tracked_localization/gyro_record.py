"""The gyro's readings of the last moments, and their mean over any of them."""

from collections import deque

from tracked_types import seconds_between

_LONGEST_STEP_S = 0.05


class GyroRecord:
    """Mean yaw rate over the very period over which the belts were counted.

    Each reading is the mean over the step that ends at its stamp. A slip estimate compares a mean of
    the belts with a mean of the gyro: over different periods the difference of the two is no slip.
    """

    def __init__(self, length: int = 64) -> None:
        self._readings: deque[tuple[int, int, float]] = deque(maxlen=length)
        self._last_ns: int | None = None

    def clear(self) -> None:
        """Forget everything."""
        self._readings.clear()
        self._last_ns = None

    def add(self, stamp_ns: int, rate_radps: float | None) -> None:
        """Note a reading (rad/s), or None: it came but cannot be trusted."""
        start_ns, self._last_ns = self._last_ns, stamp_ns
        if rate_radps is None or start_ns is None or seconds_between(stamp_ns, start_ns) > _LONGEST_STEP_S:
            return
        self._readings.append((start_ns, stamp_ns, rate_radps))

    def mean(self, start_ns: int, end_ns: int) -> tuple[float, float] | None:
        """Mean rate over (start, end] and the number of readings in it; None if less than 3/4 is covered."""
        covered, weighted, count = 0, 0.0, 0.0
        for first_ns, last_ns, rate in reversed(self._readings):
            if last_ns <= start_ns:
                break
            overlap = min(last_ns, end_ns) - max(first_ns, start_ns)
            if overlap > 0:
                covered += overlap
                weighted += rate * overlap
                count += overlap / (last_ns - first_ns)
        if covered <= 0 or 4 * covered < 3 * (end_ns - start_ns):
            return None
        return weighted / covered, count
