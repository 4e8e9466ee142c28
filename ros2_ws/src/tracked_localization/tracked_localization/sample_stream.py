"""One sensor's samples on the way to their turn."""

from bisect import insort
from collections import deque
from typing import Any

from tracked_types import NANOSECONDS_PER_SECOND

_CONFIRMATIONS = 3
_LOSS_MEMORY = 16


class SampleStream:
    """Samples of one sensor, sorted by stamp, with a memory of what was released and what is missing."""

    def __init__(self, rate_hz: int) -> None:
        self._period_ns = NANOSECONDS_PER_SECOND // rate_hz
        self._gap_ns = 3 * self._period_ns // 2
        self._pending: list[tuple[int, int, Any]] = []
        self._count = 0
        self._released: deque[int] = deque(maxlen=8)
        self.held: list[tuple[int, Any]] = []
        self.newest_ns: int | None = None
        self.heard_ns = 0
        self.frontier_ns = 0
        self.loss = 0.0

    def restart(self, start_ns: int) -> None:
        """Begin a new time line just after ``start_ns``."""
        self._pending.clear()
        self._released.clear()
        self.held.clear()
        self.newest_ns = None
        self.heard_ns = self.frontier_ns = start_ns
        self.loss = 0.0

    def queue(self, stamp_ns: int, sample: Any) -> bool:
        """Add a sample; False if one with this stamp is already waiting."""
        if any(stamp == stamp_ns for stamp, _, _ in self._pending):
            return False
        self._count += 1
        insort(self._pending, (stamp_ns, self._count, sample))
        if self.newest_ns is None or stamp_ns > self.newest_ns:
            self.newest_ns = self.heard_ns = stamp_ns
        self._extend_frontier()
        return True

    def release(self, limit_ns: int) -> list[tuple[int, Any]]:
        """Take out the samples up to ``limit_ns``."""
        taken = 0
        while taken < len(self._pending) and self._pending[taken][0] <= limit_ns:
            taken += 1
        if not taken:
            return []
        ready = [(stamp, sample) for stamp, _, sample in self._pending[:taken]]
        del self._pending[:taken]
        for stamp, _ in ready:
            self._note_loss(stamp)
            self._released.append(stamp)
        self.frontier_ns = max(self.frontier_ns, ready[-1][0])
        self._extend_frontier()
        return ready

    def has_released(self, stamp_ns: int) -> bool:
        """Whether a sample with this stamp was released lately."""
        return stamp_ns in self._released

    def falls_back(self, stamp_ns: int) -> bool:
        """Whether the stamp is so far behind the stream's own newest that the clock may have jumped."""
        return self.newest_ns is not None and stamp_ns < self.newest_ns - 2 * self._period_ns

    def hold(self, stamp_ns: int, sample: Any) -> bool:
        """Hold back a sample from another time line; True once enough of them follow one another."""
        if self.held and not 0 < stamp_ns - self.held[-1][0] <= 3 * self._period_ns:
            self.held.clear()
        self.held.append((stamp_ns, sample))
        return len(self.held) >= _CONFIRMATIONS

    def held_after(self, start_ns: int) -> list[tuple[int, Any]]:
        """Held samples that belong to a time line which starts at ``start_ns``."""
        return [(stamp, sample) for stamp, sample in self.held if 0 <= stamp - start_ns <= NANOSECONDS_PER_SECOND]

    def _extend_frontier(self) -> None:
        for stamp, _, _ in self._pending:
            if stamp - self.frontier_ns > self._gap_ns:
                return
            self.frontier_ns = max(self.frontier_ns, stamp)

    def _note_loss(self, stamp_ns: int) -> None:
        if not self._released:
            return
        periods = round((stamp_ns - self._released[-1]) / self._period_ns)
        for _ in range(min(periods - 1, 4 * _LOSS_MEMORY)):
            self.loss += (1.0 - self.loss) / _LOSS_MEMORY
        if periods >= 1:
            self.loss -= self.loss / _LOSS_MEMORY
