"""Links between the parts of the stack: latency, jitter and loss, deterministic by the seed of the run."""

import heapq
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.random import Generator, SeedSequence

from tracked_lab.conditions import Link, LinkName, Links
from tracked_lab.steering import Wire, direct
from tracked_types import to_nanoseconds

_STREAM = 0x6C696E6B  # keeps the links' draws apart from those that others make from the same seed
NAMES: tuple[LinkName, ...] = ("imu", "tracks", "pose", "estimate", "reference", "plan", "command")


class LinkScheduler:
    """Carries items over the links; the one place that decides what arrives when.

    What takes no time is handed over within `send`, as from one part of a process to the next. Everything else
    waits for `run_until`, which delivers by time, then in the order of `NAMES`, then in the order of sending.
    Every link draws from a generator of its own, so that one link's settings do not change another's fate.
    """

    def __init__(self, links: Links, seed: int) -> None:
        streams = SeedSequence([seed, _STREAM]).spawn(len(NAMES))
        self._ways = {
            name: _Way(rank, getattr(links, name), np.random.default_rng(stream))
            for rank, (name, stream) in enumerate(zip(NAMES, streams, strict=True))
        }
        self._under_way: list[tuple[int, int, int, Any, Callable[[Any], None]]] = []
        self._sequence = 0
        self.now_ns = 0
        """Time of the last delivery or of the last `run_until`."""

    def send(self, name: LinkName, item: Any, receiver: Callable[[Any], None]) -> None:
        """Send ``item`` now; ``receiver`` is called with it when it arrives, never if it gets lost."""
        way = self._ways[name]
        if way.link.ideal:
            receiver(item)
            return
        delay_ns = way.delay_ns()
        if delay_ns is None:
            return
        if delay_ns == 0:
            receiver(item)
            return
        self._post(self.now_ns + delay_ns, way.rank, item, receiver)

    def send_after(self, duration_ns: int, name: LinkName, item: Any, receiver: Callable[[Any], None]) -> None:
        """`send`, ``duration_ns`` from now: for what its sender needs that long to make."""
        self._post(self.now_ns + duration_ns, self._ways[name].rank, item, partial(self.send, name, receiver=receiver))

    def wire(self, name: LinkName) -> Wire:
        """`send` over one link."""
        return direct if self._ways[name].link.ideal else partial(self.send, name)

    def run_until(self, stamp_ns: int) -> None:
        """Deliver everything that arrives until then, what it brings about included."""
        while self._under_way and self._under_way[0][0] <= stamp_ns:
            self.now_ns, _, _, item, receiver = heapq.heappop(self._under_way)
            receiver(item)
        self.now_ns = stamp_ns

    def _post(self, at_ns: int, rank: int, item: Any, receiver: Callable[[Any], None]) -> None:
        self._sequence += 1
        heapq.heappush(self._under_way, (at_ns, rank, self._sequence, item, receiver))


class _Way:
    def __init__(self, rank: int, link: Link, generator: Generator) -> None:
        self.rank = rank
        self.link = link
        self._generator = generator
        self._latency_ns = to_nanoseconds(link.latency_s)

    def delay_ns(self) -> int | None:
        """Time under way of the next item, None if it gets lost."""
        lost, late = self._generator.random(2)  # always both, so that loss does not change the jitter
        if lost < self.link.loss:
            return None
        return self._latency_ns + to_nanoseconds(float(late) * self.link.jitter_s)
