"""Odometry that waits, in lock-step, for what its tick needs."""

from collections import deque
from collections.abc import Callable

from tracked_types import Odometry

LONGEST = 120  # far more than the simulator can run ahead once locked


class OdometryQueue:
    """Ticks odometry in order, each as soon as nothing it needs is missing.

    Parameters
    ----------
    must_wait: whether the tick of a stamp lacks something.
    tick: what is done with each odometry.
    on_overdue: told how many have waited in vain, just before they are ticked without what they lack.
    """

    def __init__(
        self,
        must_wait: Callable[[int], bool],
        tick: Callable[[Odometry], None],
        on_overdue: Callable[[int], None] = lambda _: None,
    ) -> None:
        self._must_wait = must_wait
        self._tick = tick
        self._on_overdue = on_overdue
        self._waiting: deque[Odometry] = deque()

    def add(self, odometry: Odometry) -> None:
        """One odometry in, and every tick that it or an earlier one makes possible."""
        self._waiting.append(odometry)
        self.work_off()

    def work_off(self) -> None:
        """Tick as far as may be; to be called whenever something has come that was perhaps waited for."""
        # Time that runs on although no command came is not locked: there is nothing to wait for.
        overdue = len(self._waiting) >= LONGEST
        if overdue:
            self._on_overdue(len(self._waiting))
        while self._waiting and (overdue or not self._must_wait(self._waiting[0].stamp_ns)):
            self._tick(self._waiting.popleft())
