"""When which recorded message is due."""

from collections.abc import Iterator

from tracked_bringup.bags.bag_reader import RawMessage

_NEVER_S = 3600.0


class Playback:
    """Plays messages at ``rate`` times the speed at which they were recorded; the caller owns the clock.

    The first message is due at the first call of `due`, the others as much later as their stamps say.
    """

    def __init__(self, messages: Iterator[RawMessage], rate: float) -> None:
        self._messages = messages
        self._rate = rate
        self._next = next(messages, None)
        self._offset: tuple[float, int] | None = None

    @property
    def finished(self) -> bool:
        """Whether every message has been played."""
        return self._next is None

    def due(self, now_s: float) -> RawMessage | None:
        """The next message if its time has come, by a steady clock (s); to be called until there is none."""
        if self._next is None or self.wait_s(now_s) > 0.0:
            return None
        message, self._next = self._next, next(self._messages, None)
        return message

    def wait_s(self, now_s: float) -> float:
        """Time until the next message is due; negative when late."""
        if self._next is None:
            return _NEVER_S
        if self._offset is None:
            self._offset = (now_s, self._next.stamp_ns)
        begun_s, first_ns = self._offset
        return begun_s + 1e-9 * (self._next.stamp_ns - first_ns) / self._rate - now_s

    def time_ns(self, now_s: float) -> int | None:
        """Recorded time that corresponds to ``now_s``, never beyond the next message; None before the first."""
        if self._offset is None:
            return None
        begun_s, first_ns = self._offset
        reached_ns = first_ns + round(1e9 * self._rate * (now_s - begun_s))
        return reached_ns if self._next is None else min(reached_ns, self._next.stamp_ns)
