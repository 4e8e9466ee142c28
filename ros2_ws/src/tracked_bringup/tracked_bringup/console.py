"""Terminal of the bringup: lines that stay, and one live line below them."""

import threading
from typing import TextIO

from tracked_report.terminal import coloured

_LONGEST = 150


class Console:
    """Lines and a live line, safe to use from several threads; without a terminal there is no live line."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._live = stream.isatty()
        self._status = ""
        self._lock = threading.Lock()

    def say(self, text: str, colour: str | None = None) -> None:
        """A line that stays."""
        shown = coloured(text, colour, self._stream) if colour else text
        with self._lock:
            self._clear()
            self._stream.write(f"{shown}\n")
            self._draw()

    def status(self, text: str) -> None:
        """Replace the live line; an empty text removes it."""
        with self._lock:
            if text[:_LONGEST] != self._status:
                self._clear()
                self._status = text[:_LONGEST]
                self._draw()

    def _clear(self) -> None:
        if self._live and self._status:
            self._stream.write("\r\x1b[K")

    def _draw(self) -> None:
        if self._live and self._status:
            self._stream.write(self._status)
        self._stream.flush()
