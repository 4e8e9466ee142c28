"""``out/<name>/metrics.json``: the one shape in which every run, benchmark and campaign states its figures."""

import json
import math
import os
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from tracked_report.machine import UNKNOWN, describe_machine, git_commit
from tracked_report.whole_file import write_whole

OUT_VARIABLE = "TRACKED_OUT"
"""Environment variable that moves the output folder, set for example by ``claims --quick``."""

_KEY = re.compile(r"^[a-z0-9_]+(\.[a-z0-9_]+)*$")


class MetricsError(ValueError):
    """Figures cannot be written or read; the text names the file or the key."""


@dataclass(frozen=True, slots=True)
class MetricsFile:
    """A metrics file as read back; ``values`` holds None where a figure was allowed to be missing."""

    name: str
    commit: str
    values: dict[str, float | None] = field(default_factory=dict)


def output_folder(out: Path | str | None = None) -> Path:
    """``out`` if given, else what TRACKED_OUT says, else ``out`` in the working directory."""
    return Path(out if out is not None else os.environ.get(OUT_VARIABLE, "out"))


def write_metrics(
    name: str,
    values: Mapping[str, float],
    *,
    seed: int | None = None,
    out: Path | str | None = None,
    allow_missing: Collection[str] = (),
) -> Path:
    """Write ``<out>/<name>/metrics.json`` whole and return its path.

    Keys are dotted from general to special with the unit as suffix ("double.rms_y_m"). A figure that is
    NaN or infinite is an error unless its key is in ``allow_missing``; it is then written as null.

    Raises
    ------
    MetricsError: if a key is malformed or a figure is not a finite number; nothing is written then.
    """
    if not re.fullmatch(r"[A-Za-z0-9_\-]+", name):
        raise MetricsError(f"name of the metrics must be one plain folder name, got {name!r}")
    content = {
        "name": name,
        "commit": git_commit(),
        "seed": seed,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": describe_machine(),
        "values": {key: _figure(key, value, allow_missing) for key, value in values.items()},
    }
    text = json.dumps(content, indent=2, allow_nan=False) + "\n"
    return write_whole(output_folder(out) / name / "metrics.json", text)


def read_metrics(path: Path) -> MetricsFile:
    """Read a metrics file back; a missing, damaged or foreign file raises MetricsError."""
    try:
        content: Any = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise MetricsError(f"{path}: cannot be read ({error.strerror})") from error
    except ValueError as error:
        raise MetricsError(f"{path}: is not JSON ({error})") from error
    values = content.get("values") if isinstance(content, dict) else None
    if not isinstance(values, dict):
        raise MetricsError(f"{path}: has no 'values'")
    figures: dict[str, float | None] = {}
    for key, value in values.items():
        if value is not None and (isinstance(value, bool) or not isinstance(value, int | float)):
            raise MetricsError(f"{path}: {key} is not a number (got {value!r})")
        figures[key] = None if value is None else float(value)
    return MetricsFile(str(content.get("name", path.parent.name)), str(content.get("commit", UNKNOWN)), figures)


def _figure(key: str, value: Any, allow_missing: Collection[str]) -> float | None:
    if not isinstance(key, str) or not _KEY.fullmatch(key):
        raise MetricsError(f"key {key!r} must be lower-case words joined by dots and underscores")
    try:
        number = float(value)
    except (TypeError, ValueError) as error:
        raise MetricsError(f"{key} must be a number, got {value!r}") from error
    if math.isfinite(number):
        return number
    if key in allow_missing:
        return None
    raise MetricsError(f"{key} must be finite, got {number!r}")
