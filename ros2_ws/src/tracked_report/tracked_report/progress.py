"""Progress of several commands on one terminal line, or one line per start and end where there is no terminal."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO


class Step:
    """One command under way. ``outcome``: what went wrong, empty if nothing did."""

    def __init__(self, label: str) -> None:
        self.label = label
        self.outcome = ""
        self._started = time.monotonic()

    @property
    def seconds(self) -> float:
        """Time since the start."""
        return time.monotonic() - self._started


class Progress:
    """Writes to ``stream``; safe to use from several threads."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._live = stream.isatty()
        self._running: list[Step] = []
        self._lock = threading.Lock()

    @contextmanager
    def step(self, label: str | None) -> Iterator[Step]:
        """Context of one command."""
        step = Step(label or "")
        with self._lock:
            self._running.append(step)
        if not self._live:
            self._line(f"start  {step.label}")
        try:
            yield step
        finally:
            with self._lock:
                self._running.remove(step)
            word = "failed" if step.outcome else "done  "
            self._line(f"{word} {step.label}  {step.seconds:.0f} s{'  ' + step.outcome if step.outcome else ''}")

    def show(self) -> None:
        """Refresh the live line."""
        if self._live:
            with self._lock:
                text = "  |  ".join(f"{step.label} {step.seconds:.0f} s" for step in self._running)
                self._stream.write(f"\r\x1b[K{text[:140]}")
                self._stream.flush()

    def _line(self, text: str) -> None:
        with self._lock:
            self._stream.write(f"{chr(13)}\x1b[K{text}\n" if self._live else f"{text}\n")
            self._stream.flush()
