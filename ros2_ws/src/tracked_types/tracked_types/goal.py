"""Arrival at the end of a trajectory."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class GoalReached:
    """The robot has come to rest at the end of the named trajectory, with these remaining errors."""

    stamp_ns: int
    trajectory: str
    position_error_m: float
    yaw_error_rad: float
