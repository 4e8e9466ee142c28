"""Pitch and roll of a robot that squats and sways, and what they do to a scan."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tracked_types import LaserScan, Pose2

Array = NDArray[np.float64]
_LEVELLING_S = 2.0
_LEAST_HEIGHT_M = 0.06


class Tilt:
    """Pitch (nose down positive) and roll (left side up positive) since a moment ago, by the gyro alone.

    They fade within seconds: a slope is level ground in the end, and the gyro's bias does not add up.
    """

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Begin level."""
        self.pitch_rad = self.roll_rad = 0.0

    def add(self, duration_s: float, pitch_rate_radps: float, roll_rate_radps: float) -> tuple[float, float]:
        """Take mean rates over ``duration_s`` in; changes of pitch and roll."""
        before = self.pitch_rad, self.roll_rad
        keep = math.exp(-duration_s / _LEVELLING_S)
        self.pitch_rad = keep * (self.pitch_rad + pitch_rate_radps * duration_s)
        self.roll_rad = keep * (self.roll_rad + roll_rate_radps * duration_s)
        return self.pitch_rad - before[0], self.roll_rad - before[1]


def sensor_shift(height_m: float, pitch_rad: float, roll_rad: float) -> Pose2:
    """Where a sensor of this height above the ground goes over it, in the base's frame, as the robot tilts."""
    return Pose2(height_m * math.sin(pitch_rad), -height_m * math.sin(roll_rad), 0.0)


def levelled(scan: LaserScan, yaw_rad: float, height_m: float, pitch_rad: float, roll_rad: float) -> LaserScan:
    """``scan`` with horizontal ranges, and without the beams that a tilted lidar sends to the ground.

    yaw_rad: of the lidar's mounting. The tilt is that in the middle of the revolution.
    """
    ranges = scan.ranges_m.astype(np.float64)
    angles = scan.angle_min_rad + scan.angle_increment_rad * np.arange(len(ranges)) + yaw_rad
    upwards = np.sin(angles) * math.sin(roll_rad) - np.cos(angles) * math.sin(pitch_rad)
    with np.errstate(invalid="ignore"):
        low = height_m + ranges * upwards < _LEAST_HEIGHT_M
    level = np.where(np.isfinite(ranges) & low, np.nan, ranges * np.sqrt(1.0 - upwards**2))
    return replace(scan, ranges_m=level.astype(np.float32))
