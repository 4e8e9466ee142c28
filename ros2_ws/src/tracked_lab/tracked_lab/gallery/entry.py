"""One entry of the gallery: figures of the thesis, what was found in their place, and the checks that hold it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Protocol

import numpy as np

from tracked_report.plots.style import Picture, new_figure, styled, to_svg


class Label(Enum):
    """How a figure of the thesis stands."""

    REPRODUCED = "reproduced"
    CORRECTED = "corrected"
    DIFFERS = "thesis differs"


YES_OR_NO = "yes or no"
"""The unit of statements."""


@dataclass(frozen=True, slots=True)
class Check:
    """A number found, beside the thesis's, and the interval that it must lie in; ``unit`` "" is a plain number."""

    what: str
    value: float
    low: float
    high: float
    thesis: str = "–"
    unit: str = ""

    @property
    def passed(self) -> bool:
        """Whether the number lies in its interval; NaN does not."""
        return bool(self.low <= self.value <= self.high)

    @property
    def shown(self) -> str:
        """The number with its unit."""
        if self.unit == YES_OR_NO:
            return "yes" if self.value == 1.0 else "no"
        whole = abs(self.value) < 1e6 and self.value == round(self.value)
        return f"{f'{self.value:.0f}' if whole else f'{self.value:.5g}'} {self.unit}".strip()

    @property
    def wanted(self) -> str:
        """The interval in words."""
        if self.unit == YES_OR_NO:
            return "yes"
        low, high = (f"{v:.4g}" for v in (self.low, self.high))
        if low == high:
            return low
        if np.isinf(self.low):
            return f"at most {high}"
        return f"at least {low}" if np.isinf(self.high) else f"{low} to {high}"


def holds(what: str, true: bool, thesis: str = "–") -> Check:
    """A statement that must be true."""
    return Check(what, float(true), 1.0, 1.0, thesis, YES_OR_NO)


def exactly(what: str, value: float, wanted: float, thesis: str = "–", unit: str = "") -> Check:
    """A count."""
    return Check(what, float(value), wanted, wanted, thesis, unit)


def close(what: str, value: float, wanted: float, relative: float, thesis: str = "–", unit: str = "") -> Check:
    """A number within a relative distance."""
    spread = relative * abs(wanted)
    return Check(what, float(value), wanted - spread, wanted + spread, thesis, unit)


class Illustration(Protocol):
    """What is drawn when its entry is shown."""

    def picture(self, slug: str) -> Picture:
        """The picture, its ids beginning with ``slug``."""


@dataclass(frozen=True, slots=True)
class Drawing:
    """A picture that is drawn when it is shown: ``draw`` fills a matplotlib figure."""

    title: str
    caption: str
    draw: Callable[[Any], None]
    width_in: float = 11.0
    height_in: float = 4.0

    def picture(self, slug: str) -> Picture:
        """The picture in the common style."""
        with styled():
            figure = new_figure(self.width_in, self.height_in)
            self.draw(figure)
            return Picture(slug, self.title, self.caption, to_svg(figure, slug, self.title))


@dataclass(frozen=True, slots=True)
class Entry:
    """``figures`` of the thesis, how they stand and why, with ``errata`` as rows of docs/errata.md."""

    figures: str
    title: str
    label: Label
    text: str
    checks: tuple[Check, ...]
    drawings: tuple[Illustration, ...] = ()
    errata: tuple[str, ...] = ()
    headline: str = field(default="")

    @property
    def passed(self) -> bool:
        """Whether every check holds."""
        return all(check.passed for check in self.checks)

    @property
    def slug(self) -> str:
        """Name for anchors."""
        return "".join(letter if letter.isalnum() else "-" for letter in self.figures.lower()).strip("-")
