"""Odometry estimate."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types.pose import Pose2
from tracked_types.twist import Twist2


@dataclass(frozen=True, slots=True)
class Odometry:
    """Pose of the base in ``frame_id`` and its twist in ``child_frame_id`` at one instant.

    pose_covariance: 3x3 over (x, y, yaw) in m, rad; twist_covariance: 2x2 over (speed, yaw rate).
    roll_rad, pitch_rad: of the base against the horizon, fixed-axis (REP-103); the pose is its place on the floor.
    """

    stamp_ns: int
    frame_id: str
    child_frame_id: str
    pose: Pose2
    twist: Twist2
    pose_covariance: NDArray[np.float64]
    twist_covariance: NDArray[np.float64]
    roll_rad: float = 0.0
    pitch_rad: float = 0.0
