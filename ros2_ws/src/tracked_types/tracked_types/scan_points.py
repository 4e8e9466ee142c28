"""Points of a laser scan in the robot's frame, put right for the robot's motion while the beams fired."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types.pose import Pose2
from tracked_types.pose_history import PoseHistory
from tracked_types.scan import LaserScan
from tracked_types.stamps import NANOSECONDS_PER_SECOND

Array = NDArray[np.float64]
_FLOOR_M = 0.1  # what seems lower than this is, or may be, the floor


@dataclass(frozen=True, slots=True)
class ScanPoints:
    """What one scan saw, as of one instant.

    stamp_ns: the instant. hits: ends (n, 2) of the beams that returned. misses: ends (m, 2) of beams that came back
    from nowhere, cut at the largest range. origin: where the lidar was. All in the frame of the base (m).
    """

    stamp_ns: int
    hits: Array
    misses: Array
    origin: tuple[float, float]


def scan_points(
    scan: LaserScan, lidar: Pose2, history: PoseHistory | None = None, *, height_m: float | None = None
) -> ScanPoints:
    """Points of ``scan`` as of the middle of its revolution, where that needs the least of the odometry.

    lidar: mounting in the base's frame; a lidar that hangs upside down is not meant. history: poses of the base in any
    frame that does not jump; without one, or where it does not reach, the robot is taken to have stood still.
    Beams that are NaN, -inf or outside the scan's limits say nothing and are left out. height_m: of the lidar over the
    floor; with it, and a history that knows how the robot was tilted, points are those seen from above, and beams that
    met the floor, or may have, are left out.
    """
    ranges = scan.ranges_m.astype(np.float64)
    angles = scan.angle_min_rad + scan.angle_increment_rad * np.arange(len(ranges))
    returned = np.isfinite(ranges) & (ranges >= scan.range_min_m) & (ranges <= scan.range_max_m)
    nothing = np.isposinf(ranges)
    lengths = np.where(nothing, scan.range_max_m, np.where(returned, ranges, 0.0))
    angles = angles + lidar.yaw_rad
    ends = np.column_stack([lidar.x_m + lengths * np.cos(angles), lidar.y_m + lengths * np.sin(angles)])
    stamp_ns = scan.stamp_ns
    if scan.time_increment_s > 0.0 and len(ranges):
        offsets_ns = np.rint(scan.time_increment_s * NANOSECONDS_PER_SECOND * np.arange(len(ranges))).astype(np.int64)
        stamp_ns += int(offsets_ns[-1] // 2)
        if history is not None:
            ends = _as_of(stamp_ns, ends, scan.stamp_ns + offsets_ns, history)
    origin = np.array([[lidar.x_m, lidar.y_m]])
    if height_m is not None and history is not None:
        roll, pitch = history.tilt_at(stamp_ns)
        (origin, _), (ends, heights) = (_levelled(each, height_m, roll, pitch) for each in (origin, ends))
        returned &= heights > _FLOOR_M
        nothing &= heights > _FLOOR_M
    return ScanPoints(stamp_ns, ends[returned], ends[nothing], (float(origin[0, 0]), float(origin[0, 1])))


def _levelled(points: Array, height_m: float, roll: float, pitch: float) -> tuple[Array, Array]:
    """Points (n, 2) of the base's plane at ``height_m`` as seen from above, (n, 2), and how high they are, (n,)."""
    x, y = points.T
    aside = math.cos(roll) * y - math.sin(roll) * height_m
    up = math.sin(roll) * y + math.cos(roll) * height_m
    level = np.column_stack([math.cos(pitch) * x + math.sin(pitch) * up, aside])
    return level, math.cos(pitch) * up - math.sin(pitch) * x


def _as_of(stamp_ns: int, ends: Array, stamps_ns: NDArray[np.int64], history: PoseHistory) -> Array:
    middle = history.at(np.array([stamp_ns], np.int64))
    poses = history.at(stamps_ns)
    if middle is None or poses is None:
        return ends
    x, y, yaw = (poses - middle[0]).T
    back = -middle[0, 2]
    shifted = np.column_stack([np.cos(back) * x - np.sin(back) * y, np.sin(back) * x + np.cos(back) * y])
    cosine, sine = np.cos(yaw), np.sin(yaw)
    turned = np.column_stack([cosine * ends[:, 0] - sine * ends[:, 1], sine * ends[:, 0] + cosine * ends[:, 1]])
    placed: Array = turned + shifted
    return placed
