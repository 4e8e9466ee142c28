"""What matches know: inverse covariances of x, y and yaw."""

import numpy as np
from numpy.typing import NDArray

from tracked_types import Pose2, wrap_angle

Array = NDArray[np.float64]


def with_floor(information: Array, deviation_m: float, deviation_rad: float) -> Array:
    """Information (3, 3) of no more than these deviations allow: points of a scan err together."""
    floor = np.diag(np.square([deviation_m, deviation_m, deviation_rad]))
    limited = information @ np.linalg.inv(np.eye(3) + floor @ information)
    symmetric: Array = 0.5 * (limited + limited.T)
    return symmetric


def rotation(yaw_rad: float) -> Array:
    """Turns x and y of (x, y, yaw), (3, 3)."""
    cosine, sine = np.cos(yaw_rad), np.sin(yaw_rad)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def information_in(frame: Pose2, information: Array) -> Array:
    """Information (3, 3) given in the map's axes, in the axes of ``frame``."""
    turn = rotation(frame.yaw_rad)
    turned: Array = turn.T @ information @ turn
    return turned


def posterior_of(covariance: Array, information: Array) -> Array:
    """(P^-1 + H)^-1 (3, 3) without inverting either: the information may be singular."""
    found: Array = covariance @ np.linalg.inv(np.eye(3) + information @ covariance)
    return found


def offset_to(seen: Pose2, pose: Pose2) -> Array:
    """x, y and yaw (3,) of ``seen`` less those of ``pose``, the turn the shorter way round."""
    offset = seen.as_array() - pose.as_array()
    offset[2] = wrap_angle(float(offset[2]))
    return offset


def corrected(pose: Pose2, offset: Array, information: Array, posterior: Array) -> tuple[Pose2, Array]:
    """Pose and covariance (3, 3) after something with this information was seen ``offset`` (3,) away."""
    x, y, yaw = (pose.as_array() + posterior @ information @ offset).tolist()
    return Pose2(x, y, wrap_angle(yaw)), 0.5 * (posterior + posterior.T)
