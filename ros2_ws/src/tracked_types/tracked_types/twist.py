"""Planar velocity."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Twist2:
    """Forward speed (m/s) and yaw rate (rad/s) of the base, in the base frame."""

    speed_mps: float
    yaw_rate_radps: float

    def towards_rest(self, speed_step_mps: float, yaw_rate_step_radps: float) -> "Twist2":
        """This twist, each component moved by its step (not negative) towards zero, but not past it."""
        return Twist2(
            _towards_zero(self.speed_mps, speed_step_mps), _towards_zero(self.yaw_rate_radps, yaw_rate_step_radps)
        )


def _towards_zero(value: float, step: float) -> float:
    return max(value - step, 0.0) if value > 0.0 else min(value + step, 0.0)
