"""Odometry and scans made by hand, for tests and benches without physics."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tracked_types import LaserScan, Odometry, Pose2, Twist2, to_nanoseconds

BEAMS = 360
_REST = Twist2(0.0, 0.0)
_ORIGIN = Pose2(0.0, 0.0, 0.0)


def odometry(time_s: float, pose: Pose2 = _ORIGIN, twist: Twist2 = _REST) -> Odometry:
    """One odometry at ``time_s``."""
    return Odometry(to_nanoseconds(time_s), "odom", "base_footprint", pose, twist, np.eye(3), np.eye(2))


def scan(stamp_ns: int, ranges_m: ArrayLike) -> LaserScan:
    """A revolution of 0.1 s stamped with its first beam, which looks back."""
    ranges = np.asarray(ranges_m, np.float32)
    beams = max(len(ranges), 1)
    return LaserScan(stamp_ns, "laser", -math.pi, 2.0 * math.pi / beams, 0.1 / beams, 0.1, 0.15, 18.0, ranges)


def ranges_of(points: ArrayLike, lidar: Pose2, beams: int = BEAMS) -> NDArray[np.float64]:
    """Ranges (beams,) of a lidar at the pose ``lidar`` whose nearest beam hits each point (n, 2), and nothing else."""
    seen = np.full(beams, np.inf)
    for x, y in lidar.inverse().transform(np.asarray(points, float).reshape(-1, 2)):
        index = round((math.atan2(y, x) + math.pi) / (2.0 * math.pi / beams)) % beams
        seen[index] = min(seen[index], math.hypot(x, y))
    return seen
