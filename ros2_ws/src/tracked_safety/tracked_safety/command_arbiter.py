"""Chooses whose command reaches the base, keeps it within limits, and stops the robot when nobody commands."""

import math
from collections import Counter, deque

from tracked_safety.arbiter_settings import ArbiterSettings
from tracked_safety.collision_guard import CollisionGuard
from tracked_safety.command_shaper import CommandShaper
from tracked_safety.source_roster import SourceRoster
from tracked_types import (
    ArbiterMode,
    ArbiterState,
    LaserScan,
    Odometry,
    PeriodGrid,
    Twist2,
    VelocityCommand,
    clock_set_back,
    seconds_between,
    to_nanoseconds,
)

_REST = Twist2(0.0, 0.0)
_LATCHED = (ArbiterMode.EMERGENCY_STOP, ArbiterMode.LATCHED_STOP)


class CommandArbiter:
    """One command in, at most one out, in the same call.

    Time is physical: the stamps of commands and of odometry. A source is alive until ``timeout_s`` after the
    stamp of its last good command; the live source of highest priority that is not locked passes, its stamps
    unchanged. When it falls silent and no other takes over, the ramp to zero within the braking limits starts, one
    command per control period, and zero is kept up afterwards. Stamps never go back and never run ahead of the
    newest one known.

    With a guard, what stands between two commands is judged anew when a scan comes, and when a source is slower than
    the control period. In lock-step a command instead waits for the odometry that it answers and for the scan that is
    due at its stamp, so that a run does not depend on what arrives first.
    """

    def __init__(
        self, settings: ArbiterSettings, guard: CollisionGuard | None = None, *, lock_step: bool = False
    ) -> None:
        self.settings = settings
        self.cut_off: Counter[str] = Counter()  # commands per source that limits or the guard changed
        self._guard = guard
        self._waits = lock_step and guard is not None
        self._waiting: deque[tuple[str, VelocityCommand]] = deque()
        self._shaper = CommandShaper(settings, guard)
        self._sources = SourceRoster(settings)
        self._grid = PeriodGrid(settings.rate_hz)
        self._control_period_s = 1.0 / settings.rate_hz
        self._e_stop_asserted = False
        self._mode = ArbiterMode.IDLE
        self._source = ""
        self._reason = ""
        self._now_ns: int | None = None
        self._ticked_ns: int | None = None
        self._sent: VelocityCommand | None = None
        self._acted_ns = 0  # the time as of which the last twist was judged

    @property
    def state(self) -> ArbiterState:
        """What the arbiter does now."""
        verdict = self._shaper.verdict
        return ArbiterState(
            self._now_ns or 0,
            self._mode,
            self._source,
            self._reason,
            verdict.action,
            verdict.reason,
            verdict.nearest_m,
        )

    @property
    def sent(self) -> VelocityCommand | None:
        """The last command that was let out."""
        return self._sent

    @property
    def is_waiting(self) -> bool:
        """Whether a command waits for what it is to be judged by."""
        return bool(self._waiting)

    def offer(self, source: str, command: VelocityCommand) -> VelocityCommand | None:
        """A command of one of `SOURCES`; what goes to the base because of it, if anything.

        Raises
        ------
        CommandRefused: if the command is impossible, or comes out of time; it does not keep its source alive.
        ValueError: if the source is unknown.
        """
        self._sources.hear(source, command, None if self._sent is None else self._sent.stamp_ns, self._ticked_ns)
        if self._ticked_ns is None:
            self._now_ns = command.stamp_ns
        if self._waiting or self._must_wait(command.stamp_ns):
            self._waiting.append((source, command))
            return None
        return self._pass(source, command)

    def add_odometry(self, odometry: Odometry) -> VelocityCommand | None:
        """How the robot moves, for the guard; otherwise as `tick`."""
        sent = self.tick(odometry.stamp_ns)
        if self._guard is not None:
            self._guard.add_odometry(odometry)
        return self._let_pass() or sent

    def add_scan(self, scan: LaserScan) -> VelocityCommand | None:
        """A scan for the guard; what has to be sent at once because of it, if anything.

        Raises
        ------
        ScanRefused: if the scan cannot be used.
        """
        if self._guard is None:
            return None
        self._guard.add_scan(scan)
        if self._waits:
            return self._let_pass()
        return self._judge_again() if self._mode is ArbiterMode.FORWARDING else None

    def stop_waiting(self) -> VelocityCommand | None:
        """What commands wait for does not come: judge them by what is known."""
        if self._guard is not None:
            self._guard.view.expect_none()
        return self._let_pass(all_of_them=True)

    def tick(self, stamp_ns: int) -> VelocityCommand | None:
        """An odometry has the stamp ``stamp_ns``; a command of a stop ramp when one is due.

        Time that goes back by more than half a second is a reset world: the robot stops until fresh commands.
        """
        if clock_set_back(self._now_ns, stamp_ns):
            self._clock_jumped_back()
        before_ns, self._ticked_ns = self._ticked_ns, max(stamp_ns, self._ticked_ns or 0)
        self._now_ns = self._ticked_ns
        if self._mode is ArbiterMode.FORWARDING:
            if not self._sources.is_alive(self._source, self._now_ns):
                self._stop(f"{self._source} silent for {self.settings.timeout_s:g} s")
            elif self._guard is not None and self._scan_lost():
                # A lidar that comes back after a while must not set the robot in motion.
                self._stop(f"no scan for {self._guard.settings.scan_lost_s:g} s")
                self._mode = ArbiterMode.LATCHED_STOP
        if self._mode is ArbiterMode.IDLE:
            return None
        if before_ns is not None and not self._grid.crossed(before_ns, self._now_ns):
            return None
        if self._sent is not None and self._sent.stamp_ns >= self._now_ns:
            return None
        if self._mode is not ArbiterMode.FORWARDING:
            return self._ramp(self._now_ns)
        is_slow = seconds_between(self._now_ns, self._acted_ns) > 1.5 * self._control_period_s
        return self._judge_again() if is_slow else None

    def lost_time(self) -> VelocityCommand | None:
        """Call once per control period while neither commands nor odometry arrive, by the wall clock.

        Physical time stands still then, so that `tick` cannot see the silence. Next command of the ramp, or
        None while nobody has commanded.
        """
        if self._mode is ArbiterMode.IDLE:
            return None
        if self._mode is ArbiterMode.FORWARDING:
            self._stop(f"{self._source} and the odometry silent")
        return self._ramp(self._newest_ns())

    def stop(self, reason: str) -> list[VelocityCommand]:
        """The rest of the ramp to zero, one command per control period, for a shutdown; empty while idle."""
        if self._mode is ArbiterMode.IDLE:
            return []
        self._stop(reason)
        ramp: list[VelocityCommand] = []
        while not ramp or self._shaper.twist != _REST:
            ramp.append(self._ramp(self._newest_ns()))
        return ramp

    def set_lock(self, source: str, locked: bool) -> None:
        """While it is locked, neither ``source`` nor any of lower priority passes.

        Raises
        ------
        ValueError: if the source is unknown.
        """
        self._sources.set_lock(source, locked)
        if self._mode is ArbiterMode.FORWARDING and self._sources.is_locked(self._source):
            self._stop(f"{self._source} is locked")

    def set_e_stop(self, asserted: bool) -> None:
        """The emergency stop signal; it latches, and its end alone does not release it."""
        self._e_stop_asserted = asserted
        if asserted:
            self.press_e_stop()

    def press_e_stop(self) -> None:
        """Stop until `release`, whatever the signal says."""
        self._mode, self._reason = ArbiterMode.EMERGENCY_STOP, "emergency stop pressed"

    def release(self) -> str | None:
        """End a latched stop; why it cannot be ended, or None. The robot stays at rest until fresh commands."""
        if self._mode not in _LATCHED:
            return "no stop is latched"
        if self._e_stop_asserted:
            return "the emergency stop is still pressed"
        if self._mode is ArbiterMode.LATCHED_STOP and self._scan_lost():
            return "there is no fresh scan yet"
        self._stop(f"{self._reason}; released, waiting for fresh commands")
        return None

    def _must_wait(self, stamp_ns: int) -> bool:
        if not self._waits or self._guard is None:
            return False
        due_ns = self._guard.view.next_ns
        return self._ticked_ns is None or self._ticked_ns < stamp_ns or (due_ns is not None and due_ns <= stamp_ns)

    def _let_pass(self, *, all_of_them: bool = False) -> VelocityCommand | None:
        """Commands that have waited long enough; the last of what goes to the base because of them."""
        sent = None
        while self._waiting and (all_of_them or not self._must_wait(self._waiting[0][1].stamp_ns)):
            sent = self._pass(*self._waiting.popleft()) or sent
        return sent

    def _pass(self, source: str, command: VelocityCommand) -> VelocityCommand | None:
        if self._mode in _LATCHED or not self._sources.may_pass(source, self._now_ns):
            return None
        twist = self._shaper.next(command.twist, source, command.stamp_ns, self._period_s(command.stamp_ns))
        if twist != command.twist:
            self.cut_off[source] += 1
        self._mode, self._source, self._reason = ArbiterMode.FORWARDING, source, ""
        return self._let_out(command.stamp_ns, twist)

    def _period_s(self, stamp_ns: int) -> float:
        """Time since the last command, as far as it may count towards acceleration.

        The base has held the last command meanwhile: a long gap earns no larger step.
        """
        if self._sent is None:
            return self._control_period_s
        return min(max(seconds_between(stamp_ns, self._sent.stamp_ns), 0.0), 2.0 * self._control_period_s)

    def _judge_again(self) -> VelocityCommand | None:
        """What replaces the last command, under its stamp if the base would still take that.

        Later commands of a source that lags behind must not look older than what was sent.
        """
        if self._sent is None:
            return None
        now_ns = max(self._newest_ns(), self._acted_ns)
        passed_s = min(seconds_between(now_ns, self._acted_ns), 2.0 * self._control_period_s)
        twist = self._shaper.judged_again(self._source, now_ns, passed_s)
        if twist is None:
            return None
        self.cut_off[self._source] += 1
        sent = self._let_out(max(self._sent.stamp_ns, now_ns - to_nanoseconds(0.5 * self.settings.timeout_s)), twist)
        self._acted_ns = now_ns
        return sent

    def _scan_lost(self) -> bool:
        guard, now_ns = self._guard, self._now_ns
        if guard is None or now_ns is None or guard.settings.scan_lost_s <= 0.0:
            return False
        return guard.settings.scan_lost_s < guard.view.age_s(now_ns) < math.inf

    def _stop(self, reason: str) -> None:
        self._mode = ArbiterMode.STOPPED if self._shaper.twist == _REST else ArbiterMode.STOPPING
        self._reason = reason

    def _newest_ns(self) -> int:
        return max(self._now_ns or 0, self._sent.stamp_ns if self._sent else 0)

    def _ramp(self, stamp_ns: int) -> VelocityCommand:
        twist = self._shaper.ramp(stamp_ns, self._control_period_s)
        if self._mode is ArbiterMode.STOPPING and twist == _REST:
            self._mode = ArbiterMode.STOPPED
        return self._let_out(stamp_ns, twist)

    def _let_out(self, stamp_ns: int, twist: Twist2) -> VelocityCommand:
        self._sent, self._acted_ns = VelocityCommand(stamp_ns, twist), stamp_ns
        return self._sent

    def _clock_jumped_back(self) -> None:
        self._ticked_ns, self._sent, self._acted_ns = None, None, 0
        self._sources.forget()
        self._waiting.clear()
        if self._guard is not None:
            self._guard.view.forget()
        if self._mode not in (ArbiterMode.IDLE, *_LATCHED):
            self._stop("clock jumped back")
