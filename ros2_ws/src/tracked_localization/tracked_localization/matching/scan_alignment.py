"""Scans and odometry in any order of arrival: each scan waits until the odometry covers it."""

from collections import deque
from dataclasses import dataclass, replace

import numpy as np

from tracked_description import Robot
from tracked_types import (
    LaserScan,
    Odometry,
    Pose2,
    PoseHistory,
    ScanPoints,
    StampOrder,
    clock_set_back,
    to_nanoseconds,
)
from tracked_types.scan_points import scan_points

MOST_BEAMS = 2000
_LONGEST_SCAN_S = 1.0
_MOST_WAITING = 10
_STEEPEST_RAD = 0.1


class ScanRefused(ValueError):
    """A scan cannot be used; the text says why in a few words."""


@dataclass(frozen=True, slots=True)
class AlignedScan:
    """A scan freed of the robot's motion, and the base in the odometry's frame at its instant."""

    points: ScanPoints
    odom_pose: Pose2


class ScanAlignment:
    """Pairs scans with odometry; what it gives does not depend on which of the two comes first.

    lidar: mounting in the base's frame. height_m: of the lidar over the floor; without it the robot is always level.
    """

    def __init__(self, lidar: Pose2, height_m: float | None = None) -> None:
        self._lidar, self._height_m = lidar, height_m
        self._history = PoseHistory()
        self._waiting: deque[LaserScan] = deque()
        self._scan_order = StampOrder()
        self.uncovered = 0
        """Scans so far that no odometry covered."""

    @classmethod
    def of_robot(cls, robot: Robot) -> "ScanAlignment":
        """For the robot's own lidar.

        Raises
        ------
        ValueError: it is not mounted level.
        """
        (x, y, z), (roll, pitch, yaw) = robot.lidar.xyz_m, robot.lidar.rpy_rad
        if max(abs(roll), abs(pitch)) > _STEEPEST_RAD:
            raise ValueError(f"the lidar must be mounted level, got roll {roll:g} and pitch {pitch:g} rad")
        return cls(Pose2(x, y, yaw), robot.base_link_height_m + z)

    @property
    def newest_ns(self) -> int | None:
        """Stamp of the newest odometry."""
        return self._history.newest_ns

    def odom_pose(self, stamp_ns: int) -> Pose2 | None:
        """The base in the odometry's frame at an instant; None if it is out of reach."""
        found = self._history.at(np.array([stamp_ns], np.int64))
        return None if found is None else Pose2(*found[0].tolist())

    def add_odometry(self, odometry: Odometry) -> list[AlignedScan]:
        """Take odometry in; the scans that it completes. A clock that is set back makes everything start anew."""
        if clock_set_back(self._history.newest_ns, odometry.stamp_ns):
            self._history.clear()
            self._waiting.clear()
            self._scan_order = StampOrder()
        self._history.add(odometry)
        return self._complete()

    def add_scan(self, scan: LaserScan) -> list[AlignedScan]:
        """Take a scan in; it comes back at once if the odometry covers it already.

        Raises
        ------
        ScanRefused: it takes too long or is not newer than the one before.
        """
        beams = len(scan.ranges_m)
        if scan.time_increment_s * beams > _LONGEST_SCAN_S:
            raise ScanRefused(f"takes longer than {_LONGEST_SCAN_S:g} s: scan")
        if not self._scan_order.advance(scan.stamp_ns):
            raise ScanRefused("not newer than the scan before: stamp")
        if beams > MOST_BEAMS:
            scan = _thinned(scan, -(-beams // MOST_BEAMS))
        if len(self._waiting) == _MOST_WAITING:
            self._waiting.popleft()
            self.uncovered += 1
        self._waiting.append(scan)
        return self._complete()

    def _complete(self) -> list[AlignedScan]:
        done: list[AlignedScan] = []
        newest_ns = self._history.newest_ns
        while newest_ns is not None and self._waiting and _end_ns(self._waiting[0]) <= newest_ns:
            points = scan_points(self._waiting.popleft(), self._lidar, self._history, height_m=self._height_m)
            odom_pose = self.odom_pose(points.stamp_ns)
            if odom_pose is None:
                self.uncovered += 1
            else:
                done.append(AlignedScan(points, odom_pose))
        return done


def _end_ns(scan: LaserScan) -> int:
    """When the last beam fired."""
    return scan.stamp_ns + to_nanoseconds(scan.time_increment_s * max(len(scan.ranges_m) - 1, 0))


def _thinned(scan: LaserScan, stride: int) -> LaserScan:
    return replace(
        scan,
        angle_increment_rad=scan.angle_increment_rad * stride,
        time_increment_s=scan.time_increment_s * stride,
        ranges_m=scan.ranges_m[::stride],
    )
