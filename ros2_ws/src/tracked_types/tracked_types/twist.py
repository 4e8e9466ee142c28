"""Planar velocity."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Twist2:
    """Forward speed (m/s) and yaw rate (rad/s) of the base, in the base frame."""

    speed_mps: float
    yaw_rate_radps: float
