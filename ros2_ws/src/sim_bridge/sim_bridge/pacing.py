"""When simulated time may go on: at the pace of the wall clock, freely, or in step with the commands."""

from collections import deque
from dataclasses import dataclass
from typing import Any

from tracked_description import Robot
from tracked_types import seconds_between, to_nanoseconds
from tracked_types.setting import check_settings, setting

TIME_MODES = ("paced", "unpaced", "lock_step")

_ROUNDING_NS = 1_000
"""Slack for stamps that are rounded to whole nanoseconds on several grids."""

_CATCH_UP_S = 0.05
"""Lag behind the wall clock that is made up for by running faster; beyond it the world slows down instead."""

_ASK_AGAIN_S = 0.1

_FIRST_COMMAND_PATIENCE_S = 2.0
"""Wall time for which the first command is awaited; perhaps nobody means to send one."""

_METER_WINDOW_S = 2.0


class LockStalled(RuntimeError):
    """In lock-step no command came for too long; the text names the stamp that is waited for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PacingSettings:
    """How simulated time goes on.

    budget_ns: how far it may run ahead of the newest command's stamp. odometry_period_ns: how far beyond the
    instant of the first command.
    """

    budget_ns: int
    odometry_period_ns: int
    time_mode: str = setting(
        "paced",
        "Pace of simulated time: as real time, as fast as possible, or locked to the commands (after the first)",
        choices=TIME_MODES,
    )
    first_command_s: float = setting(
        0.0,
        "Simulated time that the first command will answer; lock-step awaits it there for a while, so that every run "
        "starts alike (0: time goes on until it comes)",
        unit="s",
        low=0.0,
    )
    lock_step_limit_s: float = setting(
        10.0, "Wall time without a command after which lock-step gives up with an error", unit="s", low=0.1
    )

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: Any) -> "PacingSettings":
        """Settings with the budget that never dead-locks: one control period and one odometry period."""
        odometry_period = 1.0 / robot.odometry.rate_hz
        budget = 1.0 / robot.control.rate_hz + odometry_period
        return cls(
            budget_ns=to_nanoseconds(budget) + _ROUNDING_NS,
            odometry_period_ns=to_nanoseconds(odometry_period) + _ROUNDING_NS,
            **tuning,
        )


class Pacer:
    """Decides before every tick whether it may run yet; knows time only from its arguments."""

    def __init__(self, settings: PacingSettings) -> None:
        self._settings = settings
        self._anchor: tuple[int, float] | None = None
        self._waiting_since_s: float | None = None
        self._first_since_s: float | None = None

    def restart(self) -> None:
        """Forget the past: the world was paused or reset."""
        self._anchor = None
        self._waiting_since_s = self._first_since_s = None

    def wait_s(self, stamp_ns: int, next_stamp_ns: int, newest_command_ns: int | None, wall_s: float) -> float:
        """How long the tick from ``stamp_ns`` to ``next_stamp_ns`` has to wait yet, at ``wall_s`` of a steady clock.

        0 lets it run. A tick that waits for a command is told a time after which to ask again.

        Raises
        ------
        LockStalled: in lock-step, if a command has been waited for longer than the limit.
        """
        if self._settings.time_mode == "unpaced":
            return 0.0
        if self._settings.time_mode == "paced":
            return self._paced(stamp_ns, next_stamp_ns, wall_s)
        if newest_command_ns is not None:
            return self._locked(next_stamp_ns, newest_command_ns, wall_s)
        return self._awaiting_first(next_stamp_ns, wall_s) or self._paced(stamp_ns, next_stamp_ns, wall_s)

    def waited_s(self, wall_s: float) -> float:
        """How long lock-step has been waiting for a command, 0 if it is not."""
        return 0.0 if self._waiting_since_s is None else wall_s - self._waiting_since_s

    def _paced(self, stamp_ns: int, next_stamp_ns: int, wall_s: float) -> float:
        if self._anchor is None or self._lag_s(self._anchor, stamp_ns, wall_s) > _CATCH_UP_S:
            self._anchor = (stamp_ns, wall_s)
        return max(0.0, -self._lag_s(self._anchor, next_stamp_ns, wall_s))

    @staticmethod
    def _lag_s(anchor: tuple[int, float], stamp_ns: int, wall_s: float) -> float:
        return (wall_s - anchor[1]) - seconds_between(stamp_ns, anchor[0])

    def _awaiting_first(self, next_stamp_ns: int, wall_s: float) -> float:
        first_ns = to_nanoseconds(self._settings.first_command_s)
        if first_ns == 0 or next_stamp_ns <= first_ns + self._settings.odometry_period_ns:
            return 0.0
        if self._first_since_s is None:
            self._first_since_s = wall_s
        return _ASK_AGAIN_S if wall_s - self._first_since_s < _FIRST_COMMAND_PATIENCE_S else 0.0

    def _locked(self, next_stamp_ns: int, newest_command_ns: int, wall_s: float) -> float:
        if next_stamp_ns <= newest_command_ns + self._settings.budget_ns:
            self._waiting_since_s = None
            return 0.0
        if self._waiting_since_s is None:
            self._waiting_since_s = wall_s
        waited_s = self.waited_s(wall_s)
        if waited_s > self._settings.lock_step_limit_s:
            raise LockStalled(
                f"lock-step: no command for {waited_s:.1f} s of wall time; simulated time stands before "
                f"{next_stamp_ns / 1e9:.3f} s and the newest command answers {newest_command_ns / 1e9:.3f} s"
            )
        return _ASK_AGAIN_S


class RealTimeMeter:
    """Simulated time per wall time over the last seconds."""

    def __init__(self) -> None:
        self._marks: deque[tuple[int, float]] = deque()

    def update(self, stamp_ns: int, wall_s: float) -> float:
        """The factor at this instant; 0 until two instants differ."""
        self._marks.append((stamp_ns, wall_s))
        while len(self._marks) > 2 and self._marks[1][1] < wall_s - _METER_WINDOW_S:
            self._marks.popleft()
        first_ns, first_s = self._marks[0]
        return seconds_between(stamp_ns, first_ns) / (wall_s - first_s) if wall_s > first_s else 0.0
