"""Exceptions in callbacks: logged with the callback's name, counted, and served on."""

import os
import traceback
from collections import Counter
from collections.abc import Callable
from typing import Any, ParamSpec

Arguments = ParamSpec("Arguments")


def callback_name(callback: Callable[..., Any]) -> str:
    """How logs call a callback."""
    inner = getattr(callback, "func", callback)  # of a functools.partial
    return str(getattr(inner, "__qualname__", type(inner).__qualname__))


def debugging() -> bool:
    """Whether the user asked for tracebacks (environment variable NODE_KIT_DEBUG)."""
    return os.environ.get("NODE_KIT_DEBUG", "") not in ("", "0")


def is_milestone(count: int) -> bool:
    """Whether an event met ``count`` times is worth a line in the log: 1, 10, 100, ..."""
    while count >= 10 and count % 10 == 0:
        count //= 10
    return count == 1


class CallbackFailures:
    """Counts what callbacks raise.

    log: takes one line of text.
    on_failure: called after each failure.
    """

    def __init__(self, log: Callable[[str], Any], on_failure: Callable[[str], Any]) -> None:
        self.counts: Counter[str] = Counter()
        self.newest = ""
        self._log = log
        self._on_failure = on_failure

    def note(self, name: str, error: Exception) -> None:
        """Count one exception out of the callback ``name``; the first of a kind is logged with its traceback."""
        kind = f"{name}: {type(error).__name__}"
        self.newest = f"{name} failed: {type(error).__name__}: {error}"
        self.counts[kind] += 1
        count = self.counts[kind]
        if count == 1 or debugging():
            self._log(f"{self.newest}\n{''.join(traceback.format_exception(error)).rstrip()}")
        elif is_milestone(count):
            self._log(f"{self.newest} (time {count})")
        self._on_failure(self.newest)

    def guarded(self, callback: Callable[Arguments, Any]) -> Callable[Arguments, None]:
        """``callback`` with its exceptions noted instead of raised."""
        name = callback_name(callback)

        def guarded_callback(*args: Arguments.args, **kwargs: Arguments.kwargs) -> None:
            try:
                callback(*args, **kwargs)
            except Exception as error:
                self.note(name, error)

        return guarded_callback
