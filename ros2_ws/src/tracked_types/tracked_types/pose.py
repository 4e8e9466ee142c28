"""Planar pose."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types.angles import wrap_angle


@dataclass(frozen=True, slots=True)
class Pose2:
    """Position (m) and heading (rad, counter-clockwise from +x) of one frame in another."""

    x_m: float
    y_m: float
    yaw_rad: float

    def as_array(self) -> NDArray[np.float64]:
        """``[x, y, yaw]``, shape (3,)."""
        return np.array([self.x_m, self.y_m, self.yaw_rad])

    def compose(self, other: "Pose2") -> "Pose2":
        """``other``, given in this pose's frame, expressed in this pose's parent frame."""
        cosine, sine = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return Pose2(
            self.x_m + cosine * other.x_m - sine * other.y_m,
            self.y_m + sine * other.x_m + cosine * other.y_m,
            wrap_angle(self.yaw_rad + other.yaw_rad),
        )

    def transform(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (n, 2) of this pose's frame expressed in its parent frame (m)."""
        cosine, sine = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        turned: NDArray[np.float64] = points_m @ np.array([[cosine, sine], [-sine, cosine]])
        turned += np.array([self.x_m, self.y_m])
        return turned

    def inverse(self) -> "Pose2":
        """Pose of the parent frame in this frame."""
        cosine, sine = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return Pose2(
            -cosine * self.x_m - sine * self.y_m,
            sine * self.x_m - cosine * self.y_m,
            wrap_angle(-self.yaw_rad),
        )
