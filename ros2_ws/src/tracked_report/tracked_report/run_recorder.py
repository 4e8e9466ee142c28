"""Collects a run while it happens, from the typed values that lab and recorder node both have."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tracked_report.channel import Channel
from tracked_report.channels import CHANNELS, Row
from tracked_report.run_record import Event, RunMeta, RunRecord


@dataclass(slots=True)
class _Rows:
    columns: tuple[str, ...]
    stamps_ns: list[int] = field(default_factory=list)
    values: list[tuple[float, ...]] = field(default_factory=list)
    arrivals_s: list[float] = field(default_factory=list)

    def append(self, stamp_ns: int, values: Sequence[float], arrival_s: float) -> None:
        if len(values) != len(self.columns):
            raise ValueError(f"expected {', '.join(self.columns)}; got {len(values)} numbers")
        self.stamps_ns.append(int(stamp_ns))
        self.values.append(tuple(float(value) for value in values))
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
        if channel not in CHANNELS:
            raise KeyError(f"no channel {channel!r}; there are {', '.join(CHANNELS)}")
        kind = CHANNELS[channel]
        self._extend(channel, kind.columns, kind.rows(value), arrival_s, kind.newest_wins)

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
        self._extend(channel, columns, [(stamp_ns, tuple(values))], arrival_s, newest_wins=False)

    def add_event(self, stamp_ns: int, source: str, text: str) -> None:
        """Append something that happened once."""
        self._events.append(Event(stamp_ns=int(stamp_ns), source=source, text=text))

    def record(self, meta: RunMeta) -> RunRecord:
        """Everything collected so far."""
        return RunRecord(meta, {name: rows.channel() for name, rows in self._rows.items()}, tuple(self._events))

    def _extend(
        self, channel: str, columns: tuple[str, ...], rows: Iterable[Row], arrival_s: float, newest_wins: bool
    ) -> None:
        kept = self._rows.setdefault(channel, _Rows(columns))
        for index, (stamp_ns, values) in enumerate(rows):
            if newest_wins and index == 0:
                kept.drop_from(stamp_ns)
            kept.append(stamp_ns, values, arrival_s)
