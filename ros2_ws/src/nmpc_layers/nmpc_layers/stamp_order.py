"""Order of the stamps of one input."""

from tracked_types import to_nanoseconds

CLOCK_JUMP_NS = to_nanoseconds(0.5)  # further back than reordering explains: the world was reset


class StampOrder:
    """Tells stamps that advance from late ones and from a clock that was set back."""

    def __init__(self) -> None:
        self.latest_ns: int | None = None
        self.previous_ns = 0
        self.ignored = 0

    def advance(self, stamp_ns: int) -> bool:
        """Note a stamp; False (and counted in ``ignored``) if it does not lie after the latest.

        A stamp more than half a second back is a reset clock: it advances, see `jumps_back`.
        """
        latest = self.latest_ns
        if latest is not None and not self.jumps_back(stamp_ns) and stamp_ns <= latest:
            self.ignored += 1
            return False
        self.previous_ns = stamp_ns - 1 if latest is None or self.jumps_back(stamp_ns) else latest
        self.latest_ns = stamp_ns
        return True

    def jumps_back(self, stamp_ns: int) -> bool:
        """Whether ``stamp_ns`` means that the clock was set back."""
        return self.latest_ns is not None and stamp_ns < self.latest_ns - CLOCK_JUMP_NS
