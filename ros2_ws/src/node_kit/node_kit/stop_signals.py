"""SIGINT and SIGTERM as a request to stop."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class StopWhileStarting(BaseException):
    """A signal came before the nodes were ready."""


class StopSignals:
    """SIGINT and SIGTERM as a request that the spin loop sees; further ones are ignored."""

    def __init__(self) -> None:
        self.requested = False
        self._starting = True

    @contextmanager
    def handled(self) -> Iterator[None]:
        """Handle signals inside the block. Afterwards they stay ignored, until the process ends."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)
        try:
            yield
        finally:
            self.ignore()

    def started(self) -> None:
        """From now on a signal waits for the running callback to end."""
        self._starting = False

    def ignore(self) -> None:
        """Ignore signals: the process is stopping already."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        first = not self.requested
        self.requested = True
        if first and self._starting:
            raise StopWhileStarting
