"""A fixed-rate grid on message stamps: the stack's only notion of a periodic tick."""

from tracked_types.stamps import NANOSECONDS_PER_SECOND


class PeriodGrid:
    """Instants ``k / rate_hz`` since the epoch, rounded to whole nanoseconds.

    Nodes tick when the stamp of an input reaches the next instant, so they do the same work at any
    real-time factor and on any scheduler.

    Parameters
    ----------
    rate_hz: ticks per second, a whole number (commensurate with the rates it divides).

    Raises
    ------
    ValueError: if ``rate_hz`` is not a positive integer.
    """

    def __init__(self, rate_hz: int) -> None:
        if rate_hz <= 0 or rate_hz != int(rate_hz):
            raise ValueError(f"rate_hz must be a positive whole number, got {rate_hz!r}")
        self.rate_hz = int(rate_hz)

    def stamp_ns(self, index: int) -> int:
        """Stamp of the instant ``index`` (ns)."""
        return (index * NANOSECONDS_PER_SECOND * 2 + self.rate_hz) // (2 * self.rate_hz)

    def index_at(self, stamp_ns: int) -> int:
        """Index of the last instant at or before ``stamp_ns``."""
        # The largest index with index / rate_hz below half a nanosecond after the stamp: the inverse of the rounding.
        return ((2 * stamp_ns + 1) * self.rate_hz - 1) // (2 * NANOSECONDS_PER_SECOND)

    def is_instant(self, stamp_ns: int) -> bool:
        """Whether ``stamp_ns`` is exactly an instant of the grid."""
        return self.stamp_ns(self.index_at(stamp_ns)) == stamp_ns

    def crossed(self, previous_ns: int, stamp_ns: int) -> range:
        """Indices of the instants in (previous_ns, stamp_ns]; empty when time stands still or goes back."""
        return range(self.index_at(previous_ns) + 1, self.index_at(stamp_ns) + 1)
