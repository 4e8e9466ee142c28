"""Motion of a point fixed to the chassis, from the motion of the chassis."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim_bridge.sensors.rotations import cross_matrix, rotation_from_roll_pitch_yaw
from tracked_description.robot import Mount, Robot

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PointMotion:
    """Motion of a frame at one instant, in the world frame.

    position_m (3,); rotation (3, 3), its columns are the frame's axes; velocity_mps (3,) of the origin;
    angular_velocity_radps (3,).
    """

    position_m: Array
    rotation: Array
    velocity_mps: Array
    angular_velocity_radps: Array


@dataclass(frozen=True, slots=True)
class Mounting:
    """Where a frame sits on the chassis: ``offset_m`` (3,) from the centre of mass, ``rotation`` (3, 3)."""

    offset_m: Array
    rotation: Array

    @classmethod
    def of_sensor(cls, mount: Mount, robot: Robot) -> "Mounting":
        """Mounting of a sensor whose pose robot.yaml gives in base_link."""
        base_link = np.array([0.0, 0.0, robot.base_link_height_m - robot.chassis.com_height_m])
        return cls(base_link + np.array(mount.xyz_m), rotation_from_roll_pitch_yaw(*mount.rpy_rad))

    @classmethod
    def of_base_footprint(cls, robot: Robot) -> "Mounting":
        """Mounting of base_footprint, below the centre of mass."""
        return cls(np.array([0.0, 0.0, -robot.chassis.com_height_m]), np.eye(3))

    def motion(self, chassis: PointMotion) -> PointMotion:
        """Motion of the mounted frame, given that of the centre of mass."""
        arm = chassis.rotation @ self.offset_m
        return PointMotion(
            position_m=chassis.position_m + arm,
            rotation=chassis.rotation @ self.rotation,
            velocity_mps=chassis.velocity_mps + cross_matrix(chassis.angular_velocity_radps) @ arm,
            angular_velocity_radps=chassis.angular_velocity_radps,
        )
