"""Rotations in space as 3x3 matrices: the few conversions that the sensors need."""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SMALL_ANGLE_RAD = 1e-8


def rotation_from_roll_pitch_yaw(roll_rad: float, pitch_rad: float, yaw_rad: float) -> Array:
    """Rotation about the fixed axes x, y, z in this order (REP-103)."""
    cr, sr = math.cos(roll_rad), math.sin(roll_rad)
    cp, sp = math.cos(pitch_rad), math.sin(pitch_rad)
    cy, sy = math.cos(yaw_rad), math.sin(yaw_rad)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def roll_pitch_yaw_of(rotation: Array) -> Array:
    """Angles (3,) about the fixed axes x, y, z; the pitch lies in [-pi/2, pi/2]."""
    return np.array(
        [
            math.atan2(rotation[2, 1], rotation[2, 2]),
            math.asin(min(1.0, max(-1.0, -float(rotation[2, 0])))),
            math.atan2(rotation[1, 0], rotation[0, 0]),
        ]
    )


def cross_matrix(vector: Array) -> Array:
    """The matrix (3, 3) whose product with u is ``vector`` x u; far quicker than numpy.cross on single vectors."""
    x, y, z = vector.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rotation_from_vector(vector_rad: Array) -> Array:
    """Rotation by ``|vector_rad|`` about the direction of ``vector_rad`` (3,) (Rodrigues)."""
    angle = math.hypot(*vector_rad.tolist())
    cross = cross_matrix(vector_rad)
    rotation: Array = np.eye(3) + cross
    if angle > _SMALL_ANGLE_RAD:
        rotation += (math.sin(angle) / angle - 1.0) * cross + ((1.0 - math.cos(angle)) / angle**2) * (cross @ cross)
    return rotation


def vector_of_rotation(rotation: Array) -> Array:
    """Rotation vector (3,) of a rotation by less than pi; the inverse of `rotation_from_vector`."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    axis = 0.5 * np.array([zy - yz, xz - zx, yx - xy])
    sine = math.hypot(*axis.tolist())
    if sine < _SMALL_ANGLE_RAD:
        return axis
    return axis * (math.atan2(sine, 0.5 * (xx + yy + zz - 1.0)) / sine)
