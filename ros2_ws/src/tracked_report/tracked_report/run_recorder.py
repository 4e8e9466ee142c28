"""Collects a run while it happens, from the typed values that lab and recorder node both have."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tracked_report.channel import Channel
from tracked_report.channels import CHANNELS
from tracked_report.run_record import Event, RunMeta, RunRecord


@dataclass(slots=True)
class _Rows:
    columns: tuple[str, ...]
    stamps_ns: list[int] = field(default_factory=list)
    values: list[tuple[float, ...]] = field(default_factory=list)
    arrivals_s: list[float] = field(default_factory=list)

    def append(self, stamp_ns: int, values: tuple[float, ...], arrival_s: float) -> None:
        if len(values) != len(self.columns):
            raise ValueError(f"expected {', '.join(self.columns)}; got {len(values)} numbers")
        self.stamps_ns.append(stamp_ns)
        self.values.append(values)
        self.arrivals_s.append(arrival_s)

    def drop_from(self, stamp_ns: int) -> None:
        while self.stamps_ns and self.stamps_ns[-1] >= stamp_ns:
            self.stamps_ns.pop(), self.values.pop(), self.arrivals_s.pop()

    def channel(self) -> Channel:
        values = np.array(self.values, dtype=np.float64).reshape(len(self.stamps_ns), len(self.columns))
        return Channel(self.columns, np.array(self.stamps_ns, np.int64), values, np.array(self.arrivals_s, np.float64))


class RunRecorder:
    """Appends values to channels; `record` gives what has been collected so far, at any time.

    Example
    -------
    >>> from tracked_report.run_record import RunMeta
    >>> from tracked_types import Twist2, VelocityCommand
    >>> recorder = RunRecorder()
    >>> recorder.add("cmd_vel", VelocityCommand(20_000_000, Twist2(0.3, 0.0)))
    >>> len(recorder.record(RunMeta(scenario="example")).channel("cmd_vel"))
    1
    """

    def __init__(self) -> None:
        self._rows: dict[str, _Rows] = {}
        self._events: list[Event] = []

    def add(self, channel: str, value: Any, arrival_s: float = math.nan) -> None:
        """Append a typed value (the type the table `CHANNELS` expects) that arrived at wall time ``arrival_s``.

        Raises KeyError for a channel that the table does not know.
        """
        kind = CHANNELS.get(channel)
        if kind is None:
            raise KeyError(f"no channel {channel!r}; there are {', '.join(CHANNELS)}")
        kept = self._rows_of(channel, kind.columns)
        first = kind.newest_wins
        for stamp_ns, values in kind.rows(value):
            if first:
                kept.drop_from(stamp_ns)
                first = False
            kept.append(stamp_ns, values, arrival_s)

    def add_row(
        self,
        channel: str,
        stamp_ns: int,
        values: Sequence[float],
        *,
        columns: tuple[str, ...] | None = None,
        arrival_s: float = math.nan,
    ) -> None:
        """Append plain numbers; ``columns`` names them where the table `CHANNELS` does not know the channel.

        Raises KeyError for an unknown channel without columns, ValueError for a wrong number of values.
        """
        if columns is None:
            if channel not in CHANNELS:
                raise KeyError(f"channel {channel!r} is not in the table: name its columns")
            columns = CHANNELS[channel].columns
        numbers = tuple(float(value) for value in values)
        self._rows_of(channel, columns).append(int(stamp_ns), numbers, arrival_s)

    def add_event(self, stamp_ns: int, source: str, text: str) -> None:
        """Append something that happened once."""
        self._events.append(Event(stamp_ns=int(stamp_ns), source=source, text=text))

    def record(self, meta: RunMeta) -> RunRecord:
        """Everything collected so far."""
        return RunRecord(meta, {name: rows.channel() for name, rows in self._rows.items()}, tuple(self._events))

    def _rows_of(self, channel: str, columns: tuple[str, ...]) -> _Rows:
        kept = self._rows.get(channel)
        if kept is None:
            kept = self._rows[channel] = _Rows(columns)
        return kept
