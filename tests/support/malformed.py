"""Makes every kind of bad message out of a good one, whatever its type."""

import copy
import math
from array import array
from collections.abc import Iterator
from typing import Any

import numpy as np

HUGE_NUMBER, HUGE_SINGLE = 1e308, 3e38
BAD_NUMBERS = (math.nan, math.inf, -math.inf, HUGE_NUMBER)
HUGE = 100_000  # elements of a sequence, characters of a text
STAMPS = ((0, 0), (2**31 - 1, 0), (-1, 0), (1, 4_000_000_000))  # long ago, in 2038, before the epoch, no fraction


def malformed(good: Any) -> Iterator[Any]:
    """Copies of ``good`` with one thing wrong in each; first a message that nobody has filled in."""
    yield type(good)()
    for path, value in _leaves(good):
        largest = HUGE_SINGLE if _kind(good, path) == "float" else math.inf
        for bad in _bad_values(value):
            is_huge = isinstance(bad, float) and bad == HUGE_NUMBER
            yield _with(good, path, min(bad, largest) if is_huge else bad)
    for path, _ in _stamps(good):
        for sec, nanosec in STAMPS:
            yield _with(_with(good, (*path, "sec"), sec), (*path, "nanosec"), nanosec)


def _fields(message: Any) -> list[str]:
    return list(message.get_fields_and_field_types())


def _kind(message: Any, path: tuple[str, ...]) -> str:
    for name in path[:-1]:
        message = getattr(message, name)
    return str(message.get_fields_and_field_types()[path[-1]])


def _leaves(message: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    for name in _fields(message):
        value = getattr(message, name)
        if hasattr(value, "get_fields_and_field_types"):
            if not _is_stamp(value):
                yield from _leaves(value, (*path, name))
        else:
            yield (*path, name), value


def _stamps(message: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    for name in _fields(message):
        value = getattr(message, name)
        if hasattr(value, "get_fields_and_field_types"):
            if _is_stamp(value):
                yield (*path, name), value
            else:
                yield from _stamps(value, (*path, name))


def _is_stamp(message: Any) -> bool:
    return _fields(message) == ["sec", "nanosec"]


def _bad_values(value: Any) -> Iterator[Any]:
    if isinstance(value, float):
        yield from BAD_NUMBERS
    elif isinstance(value, str):
        yield from ("", "moon", "/moon", "x" * HUGE)
    elif isinstance(value, np.ndarray):  # of fixed size
        for bad in BAD_NUMBERS:
            worse = value.copy()
            worse[0] = bad
            yield worse
    elif isinstance(value, array):
        yield array(value.typecode)
        if value.typecode in "df":
            yield array(value.typecode, [math.nan] * max(1, len(value)))
        yield array(value.typecode, [value[0] if value else 0]) * HUGE
    elif isinstance(value, list):
        yield []
        if value:
            yield value[:1] * HUGE if isinstance(value[0], str) else value[:1] * 100


def _with(message: Any, path: tuple[str, ...], value: Any) -> Any:
    changed = copy.deepcopy(message)
    owner = changed
    for name in path[:-1]:
        owner = getattr(owner, name)
    setattr(owner, path[-1], value)
    return changed
