"""Planar laser scan."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class LaserScan:
    """One revolution of a planar lidar in its own frame (REP-117: inf is no return, NaN is no measurement).

    ranges_m: shape (n,), beam i points at ``angle_min_rad + i * angle_increment_rad`` and was taken
    ``i * time_increment_s`` after ``stamp_ns``.
    """

    stamp_ns: int
    frame_id: str
    angle_min_rad: float
    angle_increment_rad: float
    time_increment_s: float
    scan_time_s: float
    range_min_m: float
    range_max_m: float
    ranges_m: NDArray[np.float32]
