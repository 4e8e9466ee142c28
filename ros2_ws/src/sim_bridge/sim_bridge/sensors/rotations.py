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


def rotation_from_vector(vector_rad: Array) -> Array:
    """Rotation by ``|vector_rad|`` about the direction of ``vector_rad`` (3,) (Rodrigues)."""
    angle = float(np.linalg.norm(vector_rad))
    x, y, z = vector_rad
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: Array = np.eye(3) + cross
    if angle > _SMALL_ANGLE_RAD:
        rotation += (math.sin(angle) / angle - 1.0) * cross + ((1.0 - math.cos(angle)) / angle**2) * (cross @ cross)
    return rotation


def vector_of_rotation(rotation: Array) -> Array:
    """Rotation vector (3,) of a rotation by less than pi; the inverse of `rotation_from_vector`."""
    axis = 0.5 * np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    sine = float(np.linalg.norm(axis))
    if sine < _SMALL_ANGLE_RAD:
        return axis
    angle = math.atan2(sine, 0.5 * (float(np.trace(rotation)) - 1.0))
    return axis * (angle / sine)
