"""The frames that are fixed to the robot."""

import math
from dataclasses import dataclass

from tracked_description.robot import Robot

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class FixedFrame:
    """Pose of ``child`` in ``parent``: position (m) and REP-103 fixed-axis roll, pitch, yaw (rad)."""

    parent: str
    child: str
    xyz_m: Vector
    rpy_rad: Vector


def fixed_frames(robot: Robot) -> tuple[FixedFrame, ...]:
    """Base link, IMU, lidar, camera and its optical frame (REP-103: z forward, x right), parents first, no prefix."""
    names = robot.frames
    level: Vector = (0.0, 0.0, 0.0)
    return (
        FixedFrame(names.base_footprint, names.base_link, (0.0, 0.0, robot.base_link_height_m), level),
        FixedFrame(names.base_link, names.imu, robot.imu.xyz_m, robot.imu.rpy_rad),
        FixedFrame(names.base_link, names.lidar, robot.lidar.xyz_m, robot.lidar.rpy_rad),
        FixedFrame(names.base_link, names.camera, robot.camera.xyz_m, robot.camera.rpy_rad),
        FixedFrame(names.camera, names.camera_optical, level, (-0.5 * math.pi, 0.0, -0.5 * math.pi)),
    )
