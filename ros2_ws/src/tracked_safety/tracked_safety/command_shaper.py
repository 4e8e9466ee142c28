"""From the twist that somebody wants to the one that is sent: limits, smoothness, collision guard."""

import math
from dataclasses import replace

from tracked_safety.arbiter_settings import ATTENDED, ArbiterSettings
from tracked_safety.collision_guard import CollisionGuard, Permitted
from tracked_types import GuardAction, Twist2

_REST = Twist2(0.0, 0.0)
_OBSTACLE = (GuardAction.SLOWING, GuardAction.HOLDING, GuardAction.CRAWLING)


class CommandShaper:
    """Keeps every twist within the accelerations from the one before, and within what the guard permits.

    What is wanted is judged first, so that the robot slows down gently; then what would be sent is judged, since on
    its way to the wanted twist the robot drives other arcs. If that has to brake for an obstacle, it may as hard as
    the belts can.
    """

    def __init__(self, settings: ArbiterSettings, guard: CollisionGuard | None) -> None:
        self._settings = settings
        self._guard = guard
        self.twist = _REST
        self.verdict = Permitted(_REST, GuardAction.OFF if guard is None else GuardAction.PASSING)
        self._before = _REST
        self._before_s = 0.0
        self._acceleration = (0.0, 0.0)  # of the last step, never negative: how fast it sped up

    def next(self, wanted: Twist2, source: str, stamp_ns: int, period_s: float) -> Twist2:
        """The twist to send at ``stamp_ns``, ``period_s`` after the last, because ``source`` wants ``wanted``."""
        attended = source in ATTENDED
        target = self._settings.limits.clamped(wanted)
        self._judge(target, stamp_ns, attended)
        target = target if self._guard is None else self.verdict.twist
        stepped = self._smooth(target, period_s) if attended else self._approached(target, period_s)
        return self._take(self._checked(stepped, stamp_ns, self.twist, period_s, attended), period_s)

    def ramp(self, stamp_ns: int, period_s: float) -> Twist2:
        """The next twist on the way to rest."""
        stepped = self._approached(_REST, period_s)
        return self._take(self._checked(stepped, stamp_ns, self.twist, period_s, attended=False), period_s)

    def judged_again(self, source: str, stamp_ns: int, period_s: float) -> Twist2 | None:
        """What has to be sent instead of the last twist, now that more is known; None if it may stay.

        ``period_s`` after the last: with 0 the last is replaced.
        """
        if self._guard is None or self.twist == _REST:
            return None
        attended = source in ATTENDED
        self._judge(self.twist, stamp_ns, attended, gently=False)
        if self.verdict.twist == self.twist:
            return None
        since, passed_s = (self._before, self._before_s) if period_s <= 0.0 else (self.twist, period_s)
        if self.verdict.action in _OBSTACLE:
            twist = self._braked(since, self.verdict.twist, passed_s)
        else:
            twist = self._settings.limits.approached(since, self.verdict.twist, passed_s)
        if twist == self.twist:
            return None
        if period_s <= 0.0:
            self.twist = twist
            return twist
        return self._take(twist, period_s)

    def _judge(self, twist: Twist2, stamp_ns: int, attended: bool, *, gently: bool = True) -> None:
        if self._guard is not None:
            self.verdict = self._guard.permitted(twist, stamp_ns, gently=gently, attended=attended)

    def _checked(self, stepped: Twist2, stamp_ns: int, current: Twist2, period_s: float, attended: bool) -> Twist2:
        """What is sent instead, where ``stepped`` would meet an obstacle."""
        if self._guard is None:
            return stepped
        must = self._guard.permitted(stepped, stamp_ns, gently=False, attended=attended)
        if must.action not in _OBSTACLE or must.twist == stepped:
            return stepped
        self.verdict = must
        return self._braked(current, must.twist, period_s)

    def _approached(self, target: Twist2, period_s: float) -> Twist2:
        return self._settings.limits.approached(self.twist, target, period_s)

    def _braked(self, since: Twist2, target: Twist2, period_s: float) -> Twist2:
        return self._settings.limits.braked(since, target, self._settings.track_braking_mps2 * period_s)

    def _smooth(self, target: Twist2, period_s: float) -> Twist2:
        """As `_approached`, but speeding up begins and ends no faster than the jerk permits; braking is as it is."""
        settings, limits = self._settings, self._settings.limits
        speed_step = target.speed_mps - self.twist.speed_mps
        yaw_step = target.yaw_rate_radps - self.twist.yaw_rate_radps
        speed_cap = _capped(limits.acceleration_mps2, self._acceleration[0], settings.jerk_mps3, speed_step, period_s)
        yaw_cap = limits.yaw_acceleration_radps2
        if target.yaw_rate_radps * self.twist.yaw_rate_radps >= 0.0 and abs(target.yaw_rate_radps) > abs(
            self.twist.yaw_rate_radps
        ):
            yaw_cap = _capped(yaw_cap, self._acceleration[1], settings.yaw_jerk_radps3, yaw_step, period_s)
        smooth = replace(limits, acceleration_mps2=speed_cap, yaw_acceleration_radps2=yaw_cap)
        return smooth.approached(self.twist, target, period_s)

    def _take(self, twist: Twist2, period_s: float) -> Twist2:
        before, self._before, self._before_s = self.twist, self.twist, period_s
        self.twist = twist
        if period_s > 0.0:
            self._acceleration = (
                max(0.0, abs(twist.speed_mps) - abs(before.speed_mps)) / period_s,
                max(0.0, abs(twist.yaw_rate_radps) - abs(before.yaw_rate_radps)) / period_s,
            )
        return twist


def _capped(most: float, last: float, jerk: float, step: float, period_s: float) -> float:
    """Acceleration that may be taken: what the jerk builds up, and what it can end again within ``step``."""
    if jerk <= 0.0:
        return most
    return min(most, last + jerk * period_s, max(math.sqrt(2.0 * jerk * abs(step)), jerk * period_s))
