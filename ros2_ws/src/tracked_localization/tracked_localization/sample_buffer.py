"""Puts the samples of several sensors into the order of their stamps, without waiting long."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum, auto
from typing import Any

from tracked_localization.sample_stream import SampleStream
from tracked_types import to_nanoseconds


class Arrival(Enum):
    """What became of a sample."""

    QUEUED = auto()
    QUEUED_AFTER_GARBAGE = auto()
    DUPLICATE = auto()
    LATE = auto()
    HELD = auto()
    TIME_JUMPED = auto()


@dataclass(frozen=True, slots=True)
class Ready:
    """A sample whose turn has come."""

    stamp_ns: int
    stream: int
    sample: Any


class SampleBuffer:
    """Merges streams of known rates by stamp.

    A sample is released once every stream has spoken up to its stamp, without a gap, or once the newest
    stamp is ``patience_s`` ahead of it. A stream that is silent for ``silence_s`` is not waited for. The
    order of arrival within the patience does not matter to the result, once the first sample is there.

    A stamp that does not continue the common time line is held back: one such sample is garbage, a row
    of three from the same stream is a clock that has jumped (or the end of a pause), and the time line
    starts anew with them.

    Parameters
    ----------
    rates_hz: nominal rate of each stream; at equal stamps streams come in this order.
    """

    def __init__(self, rates_hz: Iterable[int], patience_s: float, silence_s: float) -> None:
        self._streams = [SampleStream(rate) for rate in rates_hz]
        self._patience_ns = to_nanoseconds(patience_s)
        self._silence_ns = to_nanoseconds(silence_s)
        self._lead_ns = self._silence_ns // 2
        self.released_ns: int | None = None
        """Nothing at or before this stamp can come any more; None before the first sample."""
        self.newest_ns: int | None = None
        """Newest stamp of any stream on the time line."""

    def silent(self, index: int) -> bool:
        """Whether the stream has said nothing for so long that nobody waits for it."""
        return self.silence_ns(index) > self._silence_ns

    def silence_ns(self, index: int) -> int:
        """For how long the stream has been silent, measured by the newest stamp of all."""
        return 0 if self.newest_ns is None else self.newest_ns - self._streams[index].heard_ns

    def loss(self, index: int) -> float:
        """Share of the stream's samples that went missing lately."""
        return self._streams[index].loss

    def add(self, index: int, stamp_ns: int, sample: Any) -> Arrival:
        """Take in one sample of stream ``index``."""
        stream = self._streams[index]
        newest = self.newest_ns
        if newest is None:
            self._start(stamp_ns)
        elif stamp_ns > newest + self._lead_ns:
            return self._hold(stream, stamp_ns, sample)
        if self.released_ns is not None and stamp_ns <= self.released_ns:
            if stream.has_released(stamp_ns):
                return Arrival.DUPLICATE
            if stream.falls_back(stamp_ns):
                return self._hold(stream, stamp_ns, sample, Arrival.LATE)
            return Arrival.LATE
        garbage = any(held_ns > stamp_ns for held_ns, _ in stream.held)
        stream.held.clear()
        if not self._queue(stream, stamp_ns, sample):
            return Arrival.DUPLICATE
        return Arrival.QUEUED_AFTER_GARBAGE if garbage else Arrival.QUEUED

    def release(self) -> list[Ready]:
        """Samples whose turn has come, in order; `released_ns` moves on."""
        newest = self.newest_ns
        if newest is None or self.released_ns is None:
            return []
        awaited = [stream.frontier_ns for index, stream in enumerate(self._streams) if not self.silent(index)]
        limit = max(min(awaited, default=newest), newest - self._patience_ns, self.released_ns)
        ready = [
            Ready(stamp, index, sample)
            for index, stream in enumerate(self._streams)
            for stamp, sample in stream.release(limit)
        ]
        ready.sort(key=lambda item: (item.stamp_ns, item.stream))
        self.released_ns = limit
        return ready

    def _hold(self, stream: SampleStream, stamp_ns: int, sample: Any, otherwise: Arrival = Arrival.HELD) -> Arrival:
        if not stream.hold(stamp_ns, sample):
            return otherwise
        first_ns = stream.held[0][0]
        continued = {id(each): each.held_after(first_ns) for each in self._streams}
        self._start(first_ns)
        for each in self._streams:
            for stamp, value in continued[id(each)]:
                self._queue(each, stamp, value)
        return Arrival.TIME_JUMPED

    def _queue(self, stream: SampleStream, stamp_ns: int, sample: Any) -> bool:
        if self.newest_ns is None or stamp_ns > self.newest_ns:
            self.newest_ns = stamp_ns
        return stream.queue(stamp_ns, sample)

    def _start(self, first_ns: int) -> None:
        # One nanosecond earlier, so that the first sample itself is still to come.
        self.released_ns = first_ns - 1
        self.newest_ns = None
        for stream in self._streams:
            stream.restart(first_ns - 1)
