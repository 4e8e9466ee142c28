"""Who may command: priorities, locks, and which of the sources are alive."""

import math

from tracked_safety.arbiter_settings import SOURCES, ArbiterSettings
from tracked_types import VelocityCommand, to_nanoseconds


class CommandRefused(ValueError):
    """A command must not pass, not even limited; ``reason`` is its class, for counting."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


class SourceRoster:
    """The `SOURCES`, the stamp of the last good command of each, and the locks."""

    def __init__(self, settings: ArbiterSettings) -> None:
        self._settings = settings
        self._timeout_ns = to_nanoseconds(settings.timeout_s)
        self._heard: dict[str, int] = {}
        self._locked: set[str] = set()

    def hear(self, source: str, command: VelocityCommand, sent_ns: int | None, now_ns: int | None) -> None:
        """Take note of a command; ``sent_ns`` is the stamp of what was sent last, ``now_ns`` of the odometry.

        Raises
        ------
        CommandRefused: if it is impossible or comes out of time; it does not keep its source alive.
        """
        require_source(source)
        refusal = self._refusal(source, command, sent_ns, now_ns)
        if refusal is not None:
            raise CommandRefused(refusal)
        self._heard[source] = command.stamp_ns

    def forget(self) -> None:
        """The clock has jumped: nobody is alive."""
        self._heard.clear()

    def set_lock(self, source: str, locked: bool) -> None:
        """Lock a source and all of lower priority, or end that."""
        require_source(source)
        if locked:
            self._locked.add(source)
        else:
            self._locked.discard(source)

    def is_alive(self, source: str, now_ns: int | None) -> bool:
        """Whether its last good command is fresh."""
        heard = self._heard.get(source)
        return heard is not None and now_ns is not None and now_ns - heard <= self._timeout_ns

    def is_locked(self, source: str) -> bool:
        """Whether a lock keeps it from passing."""
        return not self._locked.isdisjoint(SOURCES[: SOURCES.index(source) + 1])

    def may_pass(self, source: str, now_ns: int | None) -> bool:
        """Whether neither a lock nor a live source of higher priority is in its way."""
        higher = SOURCES[: SOURCES.index(source)]
        return not self.is_locked(source) and not any(self.is_alive(other, now_ns) for other in higher)

    def _refusal(self, source: str, command: VelocityCommand, sent_ns: int | None, now_ns: int | None) -> str | None:
        twist, settings = command.twist, self._settings
        if not (math.isfinite(twist.speed_mps) and math.isfinite(twist.yaw_rate_radps)):
            return "not finite"
        if settings.limits.excess(twist) > settings.refuse_beyond:
            return f"beyond {settings.refuse_beyond:g} times a limit"
        last = self._heard.get(source)
        if last is not None and command.stamp_ns <= last:
            return "stamp repeated or out of order"
        if sent_ns is not None and command.stamp_ns < sent_ns:
            return "older than what was sent"
        if now_ns is not None:
            if command.stamp_ns < now_ns - self._timeout_ns:
                return "stale stamp"
            if command.stamp_ns > now_ns + self._timeout_ns:
                return "stamp in the future"
        return None


def require_source(source: str) -> None:
    """Raise ValueError unless ``source`` is one of `SOURCES`."""
    if source not in SOURCES:
        raise ValueError(f"unknown source {source!r}; known are {', '.join(SOURCES)}")
