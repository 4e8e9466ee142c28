"""What a controller may ask of the base."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver.track_solver import TrackLimits
from tracked_description import RobotLimits
from tracked_types import Twist2

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveLimits(RobotLimits):
    """Limits of the commands (5.2.5) and of their change, as the solvers want them."""

    @property
    def low(self) -> Array:
        """Least speed and yaw rate, shape (2,)."""
        return np.array([self.speed_min_mps, -self.yaw_rate_max_radps])

    @property
    def high(self) -> Array:
        """Greatest speed and yaw rate, shape (2,)."""
        return np.array([self.speed_max_mps, self.yaw_rate_max_radps])

    @property
    def tracks(self) -> TrackLimits:
        """Limits that couple speed and yaw rate, and one command and the next."""
        return TrackLimits(
            half_gauge_m=self.half_gauge_m,
            track_speed_mps=self.track_speed_mps,
            acceleration_mps2=min(self.acceleration_mps2, self.braking_mps2),
            yaw_acceleration_radps2=self.yaw_acceleration_radps2,
        )

    def clipped(self, twist: Twist2) -> Twist2:
        """The nearest twist in the box of speed and yaw rate."""
        return Twist2(
            min(max(twist.speed_mps, self.speed_min_mps), self.speed_max_mps),
            min(max(twist.yaw_rate_radps, -self.yaw_rate_max_radps), self.yaw_rate_max_radps),
        )

    def braked(self, twist: Twist2, duration_s: float) -> Twist2:
        """``twist`` after braking for ``duration_s`` as hard as the limits allow; never beyond standstill."""
        return twist.towards_rest(self.braking_mps2 * duration_s, self.yaw_acceleration_radps2 * duration_s)
