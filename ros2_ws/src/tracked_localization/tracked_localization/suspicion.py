"""Telling a fault from a shock."""

from tracked_types import to_nanoseconds

_GROSS = 9.0
_WINDOW_NS = to_nanoseconds(0.25)


class Suspicion:
    """Whether refused samples are a sensor's fault.

    One sample just beyond the gate may be a real shock, such as an idler that hits a slat. Two within a
    quarter of a second are not, nor is one far beyond the gate.
    """

    def __init__(self) -> None:
        self._last_ns: int | None = None

    def refused(self, stamp_ns: int, excess: float) -> bool:
        """Note a refused sample, ``excess`` times beyond the gate (squared); True if the sensor is to blame."""
        last_ns, self._last_ns = self._last_ns, stamp_ns
        return excess > _GROSS or (last_ns is not None and stamp_ns - last_ns <= _WINDOW_NS)
