"""Pieces of reference on their way out of the pipeline."""

from collections import deque

from tracked_types import Trajectory, to_nanoseconds


class ReferenceFeed:
    """Holds pieces back until they are ``latency_s`` old."""

    def __init__(self, latency_s: float) -> None:
        self._latency_ns = to_nanoseconds(latency_s)
        self._waiting: deque[Trajectory] = deque()
        self.newest: Trajectory | None = None

    def add(self, piece: Trajectory) -> None:
        """A piece as it was made."""
        self._waiting.append(piece)

    def release(self, stamp_ns: int) -> Trajectory | None:
        """The newest piece that is out by ``stamp_ns``, if it was not before; `newest` is it from now on."""
        released = None
        while self._waiting and self._waiting[0].stamp_ns + self._latency_ns <= stamp_ns:
            self.newest = released = self._waiting.popleft()
        return released
