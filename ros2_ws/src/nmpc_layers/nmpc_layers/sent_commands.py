"""Commands on their way to the motors, and where they will have taken the robot."""

import math
from bisect import insort
from collections.abc import Iterator
from dataclasses import dataclass

from tracked_types import (
    PeriodGrid,
    Pose2,
    Twist2,
    VelocityCommand,
    clock_set_back,
    seconds_between,
    to_nanoseconds,
    wrap_angle,
)

MEMORY_S = 2.0
STANDSTILL = Twist2(0.0, 0.0)


class SentCommands:
    """The commands of the last two seconds by stamp, each in force at the motors a transport delay later.

    Parameters
    ----------
    transport_delay_s: from the stamp of a command to its arrival at the motors.
    """

    def __init__(self, transport_delay_s: float) -> None:
        self._delay_ns = to_nanoseconds(transport_delay_s)
        self._stamps: list[int] = []
        self._twists: dict[int, Twist2] = {}
        self._confirmed_ns: int | None = None

    def confirm(self, command: VelocityCommand) -> None:
        """Record the arbiter's word of what was sent."""
        self.add(command)
        self._confirmed_ns = command.stamp_ns

    @property
    def lacks_word_on_newest(self) -> bool:
        """Whether the newest command is no more than a guess yet."""
        return bool(self._stamps) and (self._confirmed_ns is None or self._confirmed_ns < self._stamps[-1])

    def lacks_word(self, stamp_ns: int, control: PeriodGrid) -> bool:
        """Whether commands have begun, and the word on the last control instant before ``stamp_ns`` is missing."""
        if not self._stamps:
            return False
        return self._confirmed_ns is None or self._confirmed_ns < control.stamp_ns(control.index_at(stamp_ns - 1))

    def add(self, command: VelocityCommand) -> None:
        """Record a command; one of an equal stamp replaces it, one that is not finite is ignored."""
        if not (math.isfinite(command.twist.speed_mps) and math.isfinite(command.twist.yaw_rate_radps)):
            return
        if self._stamps and clock_set_back(self._stamps[-1], command.stamp_ns):
            self.forget()
        if command.stamp_ns not in self._twists:
            insort(self._stamps, command.stamp_ns)
        self._twists[command.stamp_ns] = command.twist
        oldest = self._stamps[-1] - to_nanoseconds(MEMORY_S)
        # The last command before the window still acts in it, hence the comparison with the second.
        while len(self._stamps) > 1 and self._stamps[1] <= oldest:
            del self._twists[self._stamps.pop(0)]

    def forget(self) -> None:
        """Drop all commands."""
        self._stamps.clear()
        self._twists.clear()
        self._confirmed_ns = None

    def latest_before(self, stamp_ns: int) -> Twist2:
        """The newest command with a stamp before ``stamp_ns``; standstill if there is none."""
        for stamp in reversed(self._stamps):
            if stamp < stamp_ns:
                return self._twists[stamp]
        return STANDSTILL

    def in_force(self, start_ns: int, end_ns: int, *, before_ns: int | None = None) -> Iterator[tuple[float, Twist2]]:
        """Durations (s) and commands at the motors from ``start_ns`` to ``end_ns``, in order.

        Commands stamped ``before_ns`` or later are left out: whether an answer to the same odometry is known
        already depends on who is faster, and the prediction must not.
        """
        current, twist = start_ns, STANDSTILL
        for stamp in self._stamps:
            arrival = stamp + self._delay_ns
            if arrival >= end_ns or (before_ns is not None and stamp >= before_ns):
                break
            if arrival > current:
                yield seconds_between(arrival, current), twist
                current = arrival
            twist = self._twists[stamp]
        if end_ns > current:
            yield seconds_between(end_ns, current), twist


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundModel:
    """How belt motion becomes ground motion: see `MotionParameters`."""

    speed_slip_mps: float = 0.0
    yaw_slip_radps: float = 0.0
    yaw_efficiency: float = 1.0
    lag_s: float = 0.06
    slide_s: float = 0.0


def predict(
    pose: Pose2, belts: Twist2, commands: Iterator[tuple[float, Twist2]], ground: GroundModel
) -> tuple[Pose2, Twist2]:
    """Pose and belt twist after ``commands`` have acted; the law is that of `next_state` with a lag.

    Raises nothing: numbers that are not finite stay so.
    """
    x, y, yaw = pose.x_m, pose.y_m, pose.yaw_rad
    speed, yaw_rate = belts.speed_mps, belts.yaw_rate_radps
    for duration, command in commands:
        decay = math.exp(-duration / ground.lag_s)
        mean = ground.lag_s / duration * (1.0 - decay)
        mean_speed = command.speed_mps + mean * (speed - command.speed_mps) + ground.speed_slip_mps
        mean_rate = command.yaw_rate_radps + mean * (yaw_rate - command.yaw_rate_radps)
        turn = duration * (ground.yaw_efficiency * mean_rate + ground.yaw_slip_radps)
        heading = yaw + (0.5 - ground.slide_s / duration) * turn
        if not math.isfinite(heading):
            heading = math.nan  # cos and sin of infinity raise
        x += duration * mean_speed * math.cos(heading)
        y += duration * mean_speed * math.sin(heading)
        yaw += turn
        speed = command.speed_mps + decay * (speed - command.speed_mps)
        yaw_rate = command.yaw_rate_radps + decay * (yaw_rate - command.yaw_rate_radps)
    return Pose2(x, y, wrap_angle(yaw)), Twist2(speed, yaw_rate)
