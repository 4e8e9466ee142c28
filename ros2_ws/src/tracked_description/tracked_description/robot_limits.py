"""What may be asked of a robot's base, as plain numbers."""

from dataclasses import dataclass
from typing import Self

from tracked_description.robot import Robot


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotLimits:
    """Box of (5.2.5), the track speeds |v +- d w| it leaves out (erratum 5.2.5), and rates of change.

    Who keeps to them derives a class with the operations that it needs.
    """

    speed_min_mps: float
    speed_max_mps: float
    yaw_rate_max_radps: float
    acceleration_mps2: float
    braking_mps2: float
    yaw_acceleration_radps2: float
    track_speed_mps: float
    half_gauge_m: float

    @classmethod
    def from_robot(cls, robot: Robot) -> Self:
        """The limits of robot.yaml."""
        limits = robot.limits
        return cls(
            speed_min_mps=limits.speed_min_mps,
            speed_max_mps=limits.speed_max_mps,
            yaw_rate_max_radps=limits.yaw_rate_max_radps,
            acceleration_mps2=limits.acceleration_mps2,
            braking_mps2=limits.braking_mps2,
            yaw_acceleration_radps2=limits.yaw_acceleration_radps2,
            track_speed_mps=robot.tracks.speed_limit_mps,
            half_gauge_m=robot.tracks.gauge_m / 2.0,
        )
