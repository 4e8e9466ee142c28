"""Vectors, quaternions and covariance blocks inside messages."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from node_kit.conversions.checks import require_finite, require_unit_quaternion
from node_kit.rotations import Quaternion

PLANAR = np.array([0, 1, 5])  # x, y, yaw in the 6x6 covariance of a pose
PLANAR_BLOCK = (PLANAR[:, None] * 6 + PLANAR).ravel()
SPEED_AND_YAW_RATE = np.array([0, 5])
SPEED_BLOCK = (SPEED_AND_YAW_RATE[:, None] * 6 + SPEED_AND_YAW_RATE).ravel()


def vector_from_message(name: str, vector: Any) -> tuple[float, float, float]:
    """Components of a geometry_msgs/Vector3 or Point, all finite; ``name`` is how reasons call it."""
    x, y, z = vector.x, vector.y, vector.z
    if x - x + y - y + z - z != 0.0:  # not a number if any of them is not finite: one test for three
        for axis, value in (("x", x), ("y", y), ("z", z)):
            require_finite(f"{name}.{axis}", value)
    return x, y, z


def fill_vector(message: Any, x: float, y: float, z: float) -> None:
    """Write a geometry_msgs/Vector3 or Point."""
    message.x, message.y, message.z = float(x), float(y), float(z)


def quaternion_from_message(name: str, quaternion: Any) -> Quaternion:
    """A geometry_msgs/Quaternion of norm one."""
    return require_unit_quaternion(name, quaternion.x, quaternion.y, quaternion.z, quaternion.w)


def fill_quaternion(message: Any, quaternion: Quaternion) -> None:
    """Write a geometry_msgs/Quaternion."""
    message.x, message.y, message.z, message.w = quaternion


def sub_covariance(covariance: NDArray[np.float64], indices: NDArray[np.intp]) -> NDArray[np.float64]:
    """Block of a 6x6 covariance over some of its coordinates, shape (k, k)."""
    return covariance[indices[:, None], indices]
