"""What the base may be asked, and how fast that may change."""

import math
from dataclasses import dataclass

from tracked_description import RobotLimits
from tracked_types import Twist2


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandLimits(RobotLimits):
    """Limits that a command is judged by and brought within."""

    def excess(self, twist: Twist2) -> float:
        """How many times its limit the worst component of a finite twist asks; at most 1 within the box."""
        speed_limit = -self.speed_min_mps if twist.speed_mps < 0.0 else self.speed_max_mps
        return max(_ratio(abs(twist.speed_mps), speed_limit), abs(twist.yaw_rate_radps) / self.yaw_rate_max_radps)

    def clamped(self, twist: Twist2) -> Twist2:
        """The nearest permitted twist: each component in its box, both scaled down where a track would be too fast.

        Scaling keeps the curvature of the path.
        """
        speed = min(max(twist.speed_mps, self.speed_min_mps), self.speed_max_mps)
        yaw_rate = min(max(twist.yaw_rate_radps, -self.yaw_rate_max_radps), self.yaw_rate_max_radps)
        fastest = self._fastest_track(speed, yaw_rate)
        scale = min(1.0, self.track_speed_mps / fastest) if fastest > 0.0 else 1.0
        return Twist2(speed * scale, yaw_rate * scale)

    def approached(self, current: Twist2, target: Twist2, period_s: float) -> Twist2:
        """As far from ``current`` towards ``target`` as the accelerations permit within ``period_s``.

        Both must be permitted twists; the result is one too.
        """
        stops = abs(target.speed_mps) < abs(current.speed_mps) or target.speed_mps * current.speed_mps < 0.0
        rate = self.braking_mps2 if stops else self.acceleration_mps2
        speed_step = target.speed_mps - current.speed_mps
        yaw_step = target.yaw_rate_radps - current.yaw_rate_radps
        speed_share = _share(speed_step, rate * period_s)
        yaw_share = _share(yaw_step, self.yaw_acceleration_radps2 * period_s)
        speed = current.speed_mps + speed_share * speed_step
        yaw_rate = current.yaw_rate_radps + yaw_share * yaw_step
        if self._fastest_track(speed, yaw_rate) > self.track_speed_mps:
            # Both ends keep the track limit, so their connecting line does.
            share = min(speed_share, yaw_share)
            speed, yaw_rate = current.speed_mps + share * speed_step, current.yaw_rate_radps + share * yaw_step
        return Twist2(speed, yaw_rate)

    def braked(self, current: Twist2, target: Twist2, track_step_mps: float) -> Twist2:
        """As far from ``current`` towards ``target`` as ``track_step_mps`` takes each belt by itself."""
        left, right = (
            start + min(max(end - start, -track_step_mps), track_step_mps)
            for start, end in zip(self._belts(current), self._belts(target), strict=True)
        )
        return Twist2(0.5 * (left + right), 0.5 * (right - left) / self.half_gauge_m)

    def _belts(self, twist: Twist2) -> tuple[float, float]:
        turning = self.half_gauge_m * twist.yaw_rate_radps
        return twist.speed_mps - turning, twist.speed_mps + turning

    def _fastest_track(self, speed_mps: float, yaw_rate_radps: float) -> float:
        return abs(speed_mps) + self.half_gauge_m * abs(yaw_rate_radps)


def _ratio(value: float, limit: float) -> float:
    if value == 0.0:
        return 0.0
    return value / limit if limit > 0.0 else math.inf


def _share(step: float, largest: float) -> float:
    # The rounding of stamps to nanoseconds must not leave a last step of 1e-9 m/s.
    return 1.0 if abs(step) <= largest * (1.0 + 1e-6) else largest / abs(step)
