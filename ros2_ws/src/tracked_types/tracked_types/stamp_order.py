"""Order of the stamps of one input, and a clock that is set back."""

from tracked_types.stamps import to_nanoseconds

_LONGEST_DISORDER_NS = to_nanoseconds(0.5)  # further back than reordering explains: the world was reset


def clock_set_back(latest_ns: int | None, stamp_ns: int) -> bool:
    """Whether ``stamp_ns``, after ``latest_ns``, means that the clock was set back; never after None."""
    return latest_ns is not None and stamp_ns < latest_ns - _LONGEST_DISORDER_NS


class StampOrder:
    """Tells stamps that advance from late ones and from a clock that was set back."""

    def __init__(self) -> None:
        self.latest_ns: int | None = None
        self.previous_ns = 0
        self.ignored = 0

    def advance(self, stamp_ns: int) -> bool:
        """Note a stamp; False (and counted in ``ignored``) if it does not lie after the latest.

        A stamp more than half a second back is a reset clock: it advances, see `jumps_back`. The stamp before
        is then in ``previous_ns``; of a first one, or the first of a reset clock, that is a nanosecond less.
        """
        latest = self.latest_ns
        first = latest is None or self.jumps_back(stamp_ns)
        if latest is not None and not first and stamp_ns <= latest:
            self.ignored += 1
            return False
        self.previous_ns = stamp_ns - 1 if latest is None or first else latest
        self.latest_ns = stamp_ns
        return True

    def jumps_back(self, stamp_ns: int) -> bool:
        """Whether ``stamp_ns`` means that the clock was set back."""
        return clock_set_back(self.latest_ns, stamp_ns)
