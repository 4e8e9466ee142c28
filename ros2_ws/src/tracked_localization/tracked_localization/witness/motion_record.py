"""What belts, gyro and accelerometer have added up to, at any instant of the last moments."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from tracked_types import to_nanoseconds

Array = NDArray[np.float64]


class MotionRecord:
    """Sums over time of several quantities, linear between their samples, and a moment beyond the newest.

    Samples of different sensors with the same stamp come in any order: asked too early, a sum goes on as it went.

    Parameters
    ----------
    width: how many quantities there are.
    length_s: how long sums are kept. reach_s: how far beyond the newest sample they are still made up.
    """

    def __init__(self, width: int, length_s: float = 2.0, reach_s: float = 0.05) -> None:
        self._width = width
        self._length_ns, self._reach_ns = to_nanoseconds(length_s), to_nanoseconds(reach_s)
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self._stamps_ns: deque[int] = deque()
        self._sums: deque[tuple[float, ...]] = deque()

    @property
    def newest_ns(self) -> int | None:
        """Stamp of the newest sample."""
        return self._stamps_ns[-1] if self._stamps_ns else None

    def add(self, stamp_ns: int, *increments: float) -> None:
        """What came to each sum since the last sample; the first sample begins the sums at zero."""
        before = self._sums[-1] if self._sums else (0.0,) * self._width
        self._sums.append(tuple(total + more for total, more in zip(before, increments, strict=True)))
        self._stamps_ns.append(stamp_ns)
        while self._stamps_ns[0] < stamp_ns - self._length_ns:
            self._stamps_ns.popleft()
            self._sums.popleft()

    def between(self, start_ns: int, end_ns: int) -> Array | None:
        """What came to each sum from one instant to the other, (width,); None if either lies outside the record."""
        before, after = self.at(start_ns), self.at(end_ns)
        return None if before is None or after is None else after - before

    def at(self, stamp_ns: int) -> Array | None:
        """The sums (width,) at one instant; None outside the record."""
        stamps = self._stamps_ns
        if not stamps or not stamps[0] <= stamp_ns <= stamps[-1] + self._reach_ns:
            return None
        if stamp_ns > stamps[-1] and len(stamps) == 1:
            return None
        later = len(stamps) - 1
        while later > 0 and stamps[later - 1] >= stamp_ns:
            later -= 1
        late = np.array(self._sums[later])
        if later == 0 or stamps[later] == stamp_ns:
            return late
        early = np.array(self._sums[later - 1])
        share = (stamp_ns - stamps[later - 1]) / (stamps[later] - stamps[later - 1])
        between: Array = early + share * (late - early)
        return between
