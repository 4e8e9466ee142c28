"""The ground that the robot covers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_description.robot import Robot

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Footprint:
    """Rectangle around base_footprint: how far it reaches ahead, behind, and to each side (m)."""

    front_m: float
    rear_m: float
    half_width_m: float

    @classmethod
    def from_robot(cls, robot: Robot) -> "Footprint":
        """Belts and chassis seen from above."""
        tracks, chassis = robot.tracks, robot.chassis
        reach = max(tracks.idler_x_m + tracks.wheel_radius_m, chassis.half_extents_m[0])
        side = max(0.5 * (tracks.gauge_m + tracks.belt_width_m), chassis.half_extents_m[1])
        return cls(reach, reach, side)

    def grown(self, margin_m: float) -> "Footprint":
        """The same with so much room on every side."""
        return Footprint(self.front_m + margin_m, self.rear_m + margin_m, self.half_width_m + margin_m)

    @property
    def corners(self) -> Array:
        """(4, 2), counter-clockwise from the front left."""
        return np.array(
            [
                [self.front_m, self.half_width_m],
                [-self.rear_m, self.half_width_m],
                [-self.rear_m, -self.half_width_m],
                [self.front_m, -self.half_width_m],
            ]
        )

    def distance(self, points: Array) -> Array:
        """Distance (n,) of points (..., 2) in the base's frame from the rectangle; negative inside, by how deep."""
        x, y = points[..., 0], points[..., 1]
        ahead = np.maximum(x - self.front_m, -self.rear_m - x)
        aside = np.abs(y) - self.half_width_m
        outside = np.hypot(np.maximum(ahead, 0.0), np.maximum(aside, 0.0))
        found: Array = outside + np.minimum(np.maximum(ahead, aside), 0.0)
        return found
