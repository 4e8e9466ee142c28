"""Commands on their way from the network to the track drives: checks, transport delay, watchdog."""

import math
from collections import Counter, deque
from dataclasses import dataclass

from tracked_description import Robot
from tracked_types import Twist2, VelocityCommand, to_nanoseconds

_LIMIT_TOLERANCE = 1e-9
_REST = Twist2(0.0, 0.0)


class CommandRefused(ValueError):
    """A command cannot be taken; ``reason`` is its class, for counting, and the text the particulars."""

    def __init__(self, reason: str, particulars: str) -> None:
        super().__init__(f"{reason}: {particulars}")
        self.reason = reason


@dataclass(frozen=True, slots=True, kw_only=True)
class IntakeSettings:
    """Limits and times of the command path; see `from_robot`."""

    speed_min_mps: float
    speed_max_mps: float
    yaw_rate_max_radps: float
    braking_mps2: float
    yaw_acceleration_radps2: float
    transport_delay_ns: int
    timeout_ns: int

    @classmethod
    def from_robot(cls, robot: Robot) -> "IntakeSettings":
        """The settings that robot.yaml implies."""
        return cls(
            speed_min_mps=robot.limits.speed_min_mps,
            speed_max_mps=robot.limits.speed_max_mps,
            yaw_rate_max_radps=robot.limits.yaw_rate_max_radps,
            braking_mps2=robot.limits.braking_mps2,
            yaw_acceleration_radps2=robot.limits.yaw_acceleration_radps2,
            transport_delay_ns=to_nanoseconds(robot.control.transport_delay_s),
            timeout_ns=to_nanoseconds(robot.control.command_timeout_s),
        )


class CommandIntake:
    """Gives the twist that the drives follow at each instant.

    A command acts at its stamp plus the transport delay, so the closed loop does not depend on when the
    network delivered it; one that arrives after that instant acts at once. When the newest command's stamp
    is older than the timeout, the twist ramps to zero within the braking limits, and stays there until a
    fresh command comes.
    """

    def __init__(self, settings: IntakeSettings) -> None:
        self._settings = settings
        self._waiting: deque[VelocityCommand] = deque()
        self._newest_stamp_ns: int | None = None
        self._twist = _REST
        self.refused: Counter[str] = Counter()

    @property
    def newest_stamp_ns(self) -> int | None:
        """Stamp of the newest command taken since the last reset, None before the first."""
        return self._newest_stamp_ns

    def reset(self) -> None:
        """Forget every command and stand still; the counts of refusals remain."""
        self._waiting.clear()
        self._newest_stamp_ns = None
        self._twist = _REST

    def submit(self, command: VelocityCommand, now_ns: int) -> None:
        """Take a command, or count it as refused.

        Raises
        ------
        CommandRefused: if it is not finite, exceeds a limit, is not newer than the last one, is older than
            the timeout, or is stamped in the future.
        """
        try:
            self._check(command, now_ns)
        except CommandRefused as refusal:
            self.refused[refusal.reason] += 1
            raise
        self._newest_stamp_ns = command.stamp_ns
        self._waiting.append(command)

    def update(self, now_ns: int, period_s: float) -> Twist2:
        """The twist for the physics step that starts at ``now_ns`` and lasts ``period_s``."""
        while self._waiting and self._waiting[0].stamp_ns + self._settings.transport_delay_ns <= now_ns:
            self._twist = self._waiting.popleft().twist
        if self.timed_out(now_ns):
            self._twist = self._twist.towards_rest(
                self._settings.braking_mps2 * period_s, self._settings.yaw_acceleration_radps2 * period_s
            )
        return self._twist

    def timed_out(self, now_ns: int) -> bool:
        """Whether commands have begun and then ceased for longer than the timeout."""
        return self._newest_stamp_ns is not None and now_ns - self._newest_stamp_ns > self._settings.timeout_ns

    def _check(self, command: VelocityCommand, now_ns: int) -> None:
        speed, yaw_rate = command.twist.speed_mps, command.twist.yaw_rate_radps
        if not (math.isfinite(speed) and math.isfinite(yaw_rate)):
            raise CommandRefused("not finite", f"speed {speed!r} m/s, yaw rate {yaw_rate!r} rad/s")
        limits = self._settings
        if not limits.speed_min_mps - _LIMIT_TOLERANCE <= speed <= limits.speed_max_mps + _LIMIT_TOLERANCE:
            raise CommandRefused(
                "speed over limit", f"{speed:g} is outside {limits.speed_min_mps:g} to {limits.speed_max_mps:g} m/s"
            )
        if abs(yaw_rate) > limits.yaw_rate_max_radps + _LIMIT_TOLERANCE:
            raise CommandRefused("yaw rate over limit", f"{yaw_rate:g} exceeds {limits.yaw_rate_max_radps:g} rad/s")
        if command.stamp_ns > now_ns:
            raise CommandRefused("stamped in the future", f"{command.stamp_ns} ns at a simulated time of {now_ns} ns")
        if now_ns - command.stamp_ns > limits.timeout_ns:
            raise CommandRefused("stale", f"{(now_ns - command.stamp_ns) / 1e9:g} s old")
        if self._newest_stamp_ns is not None and command.stamp_ns < self._newest_stamp_ns:
            raise CommandRefused("out of order", f"{command.stamp_ns} ns follows {self._newest_stamp_ns} ns")
