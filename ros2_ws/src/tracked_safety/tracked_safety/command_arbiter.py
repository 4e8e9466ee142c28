"""Chooses whose command reaches the base, keeps it within limits, and stops the robot when nobody commands."""

import math
from collections import Counter

from tracked_safety.arbiter_settings import SOURCES, ArbiterSettings
from tracked_types import (
    ArbiterMode,
    ArbiterState,
    PeriodGrid,
    Twist2,
    VelocityCommand,
    clock_set_back,
    seconds_between,
    to_nanoseconds,
)

_REST = Twist2(0.0, 0.0)


class CommandRefused(ValueError):
    """A command must not pass, not even limited; ``reason`` is its class, for counting."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


class CommandArbiter:
    """One command in, at most one out, in the same call.

    Time is physical: the stamps of commands and of odometry. A source is alive until ``timeout_s`` after the
    stamp of its last good command; the live source of highest priority passes, its stamps unchanged. When it
    falls silent and no other takes over, the ramp to zero within the braking limits starts, one command per
    control period, and zero is kept up afterwards. Stamps never go back and never run ahead of the newest
    one known.
    """

    def __init__(self, settings: ArbiterSettings) -> None:
        self.settings = settings
        self.cut_off: Counter[str] = Counter()  # commands per source that limits changed
        self._grid = PeriodGrid(settings.rate_hz)
        self._timeout_ns = to_nanoseconds(settings.timeout_s)
        self._control_period_s = 1.0 / settings.rate_hz
        self._e_stop_asserted = False
        self._mode = ArbiterMode.IDLE
        self._source = ""
        self._reason = ""
        self._now_ns: int | None = None
        self._ticked_ns: int | None = None
        self._heard: dict[str, int] = {}  # stamp of the last good command of a source
        self._sent: VelocityCommand | None = None
        self._twist = _REST

    @property
    def state(self) -> ArbiterState:
        """What the arbiter does now."""
        return ArbiterState(self._now_ns or 0, self._mode, self._source, self._reason)

    @property
    def sent(self) -> VelocityCommand | None:
        """The last command that was let out."""
        return self._sent

    def offer(self, source: str, command: VelocityCommand) -> VelocityCommand | None:
        """A command of one of `SOURCES`; what goes to the base because of it, if anything.

        Raises
        ------
        CommandRefused: if the command is impossible, or comes out of time; it does not keep its source alive.
        ValueError: if the source is unknown.
        """
        if source not in SOURCES:
            raise ValueError(f"unknown source {source!r}; known are {', '.join(SOURCES)}")
        refusal = self._refusal(source, command)
        if refusal is not None:
            raise CommandRefused(refusal)
        self._heard[source] = command.stamp_ns
        if self._ticked_ns is None:
            self._now_ns = command.stamp_ns
        if self._mode is ArbiterMode.EMERGENCY_STOP or self._outranked(source):
            return None
        permitted = self.settings.limits.clamped(command.twist)
        twist = self.settings.limits.approached(self._twist, permitted, self._period_s(command.stamp_ns))
        if twist != command.twist:
            self.cut_off[source] += 1
        self._mode, self._source, self._reason = ArbiterMode.FORWARDING, source, ""
        return self._let_out(VelocityCommand(command.stamp_ns, twist))

    def tick(self, stamp_ns: int) -> VelocityCommand | None:
        """An odometry has the stamp ``stamp_ns``; a command of a stop ramp when one is due.

        Time that goes back by more than half a second is a reset world: the robot stops until fresh commands.
        """
        if clock_set_back(self._now_ns, stamp_ns):
            self._clock_jumped_back()
        before_ns, self._ticked_ns = self._ticked_ns, max(stamp_ns, self._ticked_ns or 0)
        self._now_ns = self._ticked_ns
        if self._mode is ArbiterMode.FORWARDING and not self._alive(self._source):
            self._stop(f"{self._source} silent for {self.settings.timeout_s:g} s")
        if self._mode in (ArbiterMode.FORWARDING, ArbiterMode.IDLE):
            return None
        if before_ns is not None and not self._grid.crossed(before_ns, self._now_ns):
            return None
        if self._sent is not None and self._sent.stamp_ns >= self._now_ns:
            return None
        return self._ramp(self._now_ns, self._control_period_s)

    def lost_time(self) -> VelocityCommand | None:
        """Call once per control period while neither commands nor odometry arrive, by the wall clock.

        Physical time stands still then, so that `tick` cannot see the silence. Next command of the ramp, or
        None while nobody has commanded.
        """
        if self._mode is ArbiterMode.IDLE:
            return None
        if self._mode is ArbiterMode.FORWARDING:
            self._stop(f"{self._source} and the odometry silent")
        return self._ramp(self._newest_ns(), self._control_period_s)

    def stop(self, reason: str) -> list[VelocityCommand]:
        """The rest of the ramp to zero, one command per control period, for a shutdown; empty while idle."""
        if self._mode is ArbiterMode.IDLE:
            return []
        self._stop(reason)
        ramp: list[VelocityCommand] = []
        while not ramp or self._twist != _REST:
            ramp.append(self._ramp(self._newest_ns(), self._control_period_s))
        return ramp

    def set_e_stop(self, asserted: bool) -> None:
        """The emergency stop signal; it latches, and its end alone does not release it."""
        self._e_stop_asserted = asserted
        if asserted:
            self._mode, self._reason = ArbiterMode.EMERGENCY_STOP, "emergency stop pressed"

    def release(self) -> str | None:
        """End an emergency stop; why it cannot be ended, or None. The robot stays at rest until fresh commands."""
        if self._mode is not ArbiterMode.EMERGENCY_STOP:
            return "no emergency stop is latched"
        if self._e_stop_asserted:
            return "the emergency stop is still pressed"
        self._stop("emergency stop released, waiting for fresh commands")
        return None

    def _refusal(self, source: str, command: VelocityCommand) -> str | None:
        twist = command.twist
        if not (math.isfinite(twist.speed_mps) and math.isfinite(twist.yaw_rate_radps)):
            return "not finite"
        if self.settings.limits.excess(twist) > self.settings.refuse_beyond:
            return f"beyond {self.settings.refuse_beyond:g} times a limit"
        last = self._heard.get(source)
        if last is not None and command.stamp_ns <= last:
            return "stamp repeated or out of order"
        if self._sent is not None and command.stamp_ns < self._sent.stamp_ns:
            return "older than what was sent"
        if self._ticked_ns is not None:
            if command.stamp_ns < self._ticked_ns - self._timeout_ns:
                return "stale stamp"
            if command.stamp_ns > self._ticked_ns + self._timeout_ns:
                return "stamp in the future"
        return None

    def _alive(self, source: str) -> bool:
        heard = self._heard.get(source)
        return heard is not None and self._now_ns is not None and self._now_ns - heard <= self._timeout_ns

    def _outranked(self, source: str) -> bool:
        return any(self._alive(other) for other in SOURCES[: SOURCES.index(source)])

    def _period_s(self, stamp_ns: int) -> float:
        """Time since the last command, as far as it may count towards acceleration.

        The base has held the last command meanwhile: a long gap earns no larger step.
        """
        if self._sent is None:
            return self._control_period_s
        return min(seconds_between(stamp_ns, self._sent.stamp_ns), 2.0 * self._control_period_s)

    def _stop(self, reason: str) -> None:
        self._mode = ArbiterMode.STOPPED if self._twist == _REST else ArbiterMode.STOPPING
        self._reason = reason

    def _newest_ns(self) -> int:
        return max(self._now_ns or 0, self._sent.stamp_ns if self._sent else 0)

    def _ramp(self, stamp_ns: int, period_s: float) -> VelocityCommand:
        twist = self.settings.limits.approached(self._twist, _REST, period_s)
        if self._mode is ArbiterMode.STOPPING and twist == _REST:
            self._mode = ArbiterMode.STOPPED
        return self._let_out(VelocityCommand(stamp_ns, twist))

    def _let_out(self, command: VelocityCommand) -> VelocityCommand:
        self._sent, self._twist = command, command.twist
        return command

    def _clock_jumped_back(self) -> None:
        self._ticked_ns, self._sent = None, None
        self._heard.clear()
        if self._mode not in (ArbiterMode.IDLE, ArbiterMode.EMERGENCY_STOP):
            self._stop("clock jumped back")
