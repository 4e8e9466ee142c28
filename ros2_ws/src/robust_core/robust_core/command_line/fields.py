"""Reading mappings key by key, with errors that name the key, and none left unread."""

import difflib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

import numpy as np

from robust_core.command_line.expressions import number
from robust_core.errors import ArgumentError, RobustCoreError


class SpecError(RobustCoreError, ValueError):
    """A specification is not what it must be; the text names the key."""

    def __init__(self, key: str, problem: str) -> None:
        super().__init__(f"{key}: {problem}")
        self.key = key


class Fields:
    """A mapping of a specification, and its place in it."""

    def __init__(self, content: Any, place: str = "") -> None:
        if not isinstance(content, dict):
            raise SpecError(place or "the specification", f"must be a mapping of keys, got {shown(content)}")
        for key in content:
            if not isinstance(key, str):
                raise SpecError(place or "the specification", f"keys are texts, got {shown(key)}")
        self.content: dict[str, Any] = content
        self.place = place

    def key(self, name: str) -> str:
        """Full name of a key, for messages."""
        return f"{self.place}.{name}" if self.place else name

    def only(self, *allowed: str) -> None:
        """Refuse keys beside these, with the nearest name."""
        for name in self.content:
            if name not in allowed:
                near = difflib.get_close_matches(name, allowed, n=1)
                hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(allowed)}"
                raise SpecError(self.key(name), f"is no key here; {hint}")

    def has(self, name: str) -> bool:
        """Whether a key is there with a value."""
        return self.content.get(name) is not None

    def get(self, name: str, wanted: str) -> Any:
        """A value that must be there; ``wanted`` says what it is."""
        if not self.has(name):
            raise SpecError(self.key(name), f"is missing: {wanted}")
        return self.content[name]

    def part(self, name: str) -> "Fields":
        """A mapping within."""
        return Fields(self.get(name, "a mapping of keys"), self.key(name))

    def text(self, name: str, default: str | None = None, choices: tuple[str, ...] = ()) -> str:
        """A text, one of ``choices`` where there are any."""
        value = default if default is not None and not self.has(name) else self.get(name, "a text")
        value = str(value) if isinstance(value, int | float) and not isinstance(value, bool) else value
        if not isinstance(value, str) or (choices and value not in choices):
            wanted = "one of " + ", ".join(choices) if choices else "a text"
            raise SpecError(self.key(name), f"must be {wanted}, got {shown(value)}")
        return value

    def number(self, name: str, default: float | None = None) -> float:
        """A number, or a formula of numbers."""
        if default is not None and not self.has(name):
            return default
        with self.about(name):
            return float(number(_plain_number(self.get(name, "a number"))))

    def whole(self, name: str, default: int | None = None, *, low: int = 0, high: int = 10**6) -> int:
        """A whole number within bounds."""
        value = default if default is not None and not self.has(name) else self.get(name, "a whole number")
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise SpecError(self.key(name), f"must be a whole number from {low} to {high}, got {shown(value)}")
        return value

    def array(self, name: str) -> Any:
        """Nested lists of numbers as an array of exact numbers (floats as the decimals that are written)."""
        return self.entries(name, lambda value: _exact(number(_plain_number(value))))

    def floats(self, name: str) -> Any:
        """Nested lists of numbers as an array of floats."""
        return self.entries(name, lambda value: float(number(_plain_number(value)))).astype(np.float64)

    def entries(self, name: str, read: Callable[[Any], Any]) -> Any:
        """Nested lists as an array of objects, each entry read on its own."""

        def walk(value: Any, place: str) -> Any:
            if isinstance(value, list):
                return [walk(item, f"{place}[{k}]") for k, item in enumerate(value)]
            try:
                return read(value)
            except ArgumentError as error:
                raise SpecError(place, str(error)) from error

        value = walk(self.get(name, "numbers in lists"), self.key(name))
        shape = _shape(value)
        if shape is None:
            raise SpecError(self.key(name), "has rows of different lengths")
        flat = np.empty(int(np.prod(shape)), dtype=object)
        for k, item in enumerate(_flat(value)):
            flat[k] = item
        return flat.reshape(shape)

    @contextmanager
    def about(self, name: str = "") -> Iterator[None]:
        """Errors about arguments become errors about this key."""
        try:
            yield
        except ArgumentError as error:
            raise SpecError(self.key(name) if name else self.place, str(error)) from error


def shown(value: Any) -> str:
    """A value in a message, cut where it is long."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _plain_number(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ArgumentError("number", "a number or a formula of numbers", shown(value))
    return value


def _exact(value: Fraction | float) -> Fraction:
    return Fraction(value)


def _shape(value: Any) -> tuple[int, ...] | None:
    if not isinstance(value, list):
        return ()
    inner = {_shape(item) for item in value}
    if len(inner) > 1 or None in inner:
        return None
    return (len(value), *(next(iter(inner)) or ())) if inner else (0,)


def _flat(value: Any) -> Iterator[Any]:
    if isinstance(value, list):
        for item in value:
            yield from _flat(item)
    else:
        yield value
