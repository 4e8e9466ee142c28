"""What a node says of its own health: named tasks with level, message and values. No ROS."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum


class Level(IntEnum):
    """Levels of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(slots=True)
class TaskReport:
    """The newest report of one task."""

    name: str
    level: Level
    message: str
    values: dict[str, str] = field(default_factory=dict)


class DiagnosticBook:
    """Newest report of every task, and which of them are urgent.

    A change of level is urgent at once; a change of the message alone, at most once per ``message_period_s``, so that
    a message with a number in it cannot flood the network.
    """

    def __init__(self, message_period_s: float = 0.1) -> None:
        self._message_period_s = message_period_s
        self._reports: dict[str, TaskReport] = {}
        self._published_s: dict[str, float] = {}

    def report(
        self, name: str, level: Level, message: str, values: Mapping[str, object], now_s: float
    ) -> TaskReport | None:
        """Note a report made at ``now_s`` (any steady clock); returns it if it should be published at once."""
        previous = self._reports.get(name)
        current = TaskReport(name, level, message, {key: _text(value) for key, value in values.items()})
        self._reports[name] = current
        if previous is None or previous.level != level:
            urgent = True
        elif previous.message != message:
            urgent = now_s - self._published_s[name] >= self._message_period_s
        else:
            urgent = False
        if not urgent:
            return None
        self._published_s[name] = now_s
        return current

    def all(self) -> list[TaskReport]:
        """Newest report of every task, in order of first report."""
        return list(self._reports.values())


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
