"""Figures of a run, and why some of them are not there."""

import math
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class MetricSheet:
    """``values``: finite figures by dotted key. ``missing``: key (or group of keys) -> reason in words."""

    values: dict[str, float] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)

    def put(self, key: str, value: float, otherwise: str = "is not a finite number") -> None:
        """Enter a figure, or the reason why there is none."""
        if math.isfinite(value):
            self.values[key] = float(value)
        else:
            self.missing[key] = otherwise

    def update(self, other: "MetricSheet", prefix: str = "") -> None:
        """Take over another sheet's figures and reasons, each key behind ``prefix.``."""
        lead = f"{prefix}." if prefix else ""
        self.values.update({f"{lead}{key}": value for key, value in other.values.items()})
        self.missing.update({f"{lead}{key}": reason for key, reason in other.missing.items()})


class NotRecordedError(ValueError):
    """A figure cannot be made from what was recorded; the text says what is missing."""
