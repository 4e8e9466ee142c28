"""State of the simulated vehicle, and what follows from it in the frames that sensors and reports use."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types import Pose2

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class VehicleState:
    """State after ``step_index`` physics steps; vectors in the world unless said otherwise.

    position_m, velocity_mps: (3,) of the chassis' centre of mass. quaternion: (4,) x, y, z, w. rotation: (3, 3) base
    to world. angular_velocity_radps: (3,). belt_travel_m, belt_speed_mps, motor_force_n: (2,) left, right.
    suspension_travel_m: (units,) left rear to left front, then right; negative in compression.
    com_height_m: height of the centre of mass over base_footprint.
    """

    step_index: int
    position_m: Array
    quaternion: Array
    rotation: Array
    velocity_mps: Array
    angular_velocity_radps: Array
    belt_travel_m: Array
    belt_speed_mps: Array
    motor_force_n: Array
    suspension_travel_m: Array
    com_height_m: float

    def point_m(self, offset_m: Array) -> Array:
        """World position of a point fixed to the base, ``offset_m`` (3,) from base_footprint in base axes."""
        return self.position_m + self.rotation @ self._from_com(offset_m)

    def point_velocity_mps(self, offset_m: Array) -> Array:
        """World velocity of that point."""
        lever_m = self.rotation @ self._from_com(offset_m)
        return self.velocity_mps + np.cross(self.angular_velocity_radps, lever_m)

    def _from_com(self, offset_m: Array) -> Array:
        from_com: Array = np.asarray(offset_m, dtype=np.float64) - np.array([0.0, 0.0, self.com_height_m])
        return from_com

    @property
    def base_position_m(self) -> Array:
        """World position of base_footprint, (3,)."""
        return self.point_m(np.zeros(3))

    @property
    def base_velocity_mps(self) -> Array:
        """Velocity of base_footprint in base axes, (3,)."""
        velocity: Array = self.rotation.T @ self.point_velocity_mps(np.zeros(3))
        return velocity

    @property
    def roll_pitch_yaw_rad(self) -> Array:
        """Fixed-axis angles of REP-103, (3,)."""
        r = self.rotation
        return np.array(
            [
                math.atan2(r[2, 1], r[2, 2]),
                math.asin(min(max(-float(r[2, 0]), -1.0), 1.0)),
                math.atan2(r[1, 0], r[0, 0]),
            ]
        )

    @property
    def base_pose(self) -> Pose2:
        """Planar pose of base_footprint."""
        x, y, _ = self.base_position_m.tolist()
        return Pose2(x, y, math.atan2(self.rotation[1, 0], self.rotation[0, 0]))
