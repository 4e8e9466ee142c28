"""What the newest scan shows, carried on by how the robot has moved since each beam fired."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tracked_safety.guard_settings import GuardSettings
from tracked_types import LaserScan, Odometry, PoseHistory, angle_difference, seconds_between, to_nanoseconds
from tracked_types.scan_points import ScanPoints, scan_points

Array = NDArray[np.float64]
_FUTURE_NS = to_nanoseconds(0.1)
_HISTORY_S = 1.0
# Beyond any robot of this kind: the odometry was put somewhere else.
_JUMP_M, _JUMP_RAD = 0.05, 0.1
_JUMP_MPS, _JUMP_RADPS = 2.0, 4.0


class ScanRefused(ValueError):
    """A scan cannot be used; ``reason`` is its class, for counting."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


class ScanView:
    """Newest scan and recent odometry. Time is that of the stamps, and its newest is that of the odometry."""

    def __init__(self, settings: GuardSettings) -> None:
        self._settings = settings
        self._history = PoseHistory(length_s=_HISTORY_S)
        self._last: Odometry | None = None
        self._scan: LaserScan | None = None
        self._straightened: ScanPoints | None = None  # what the scan saw, once the odometry has reached its end
        self._stamp_ns = 0
        self._end_ns: int | None = None
        self._next_ns: int | None = None

    @property
    def next_ns(self) -> int | None:
        """When the next scan is due, if that is known: the end of its last beam."""
        return self._next_ns

    def expect_none(self) -> None:
        """Whoever waits for the next scan has waited long enough; the one after it will be expected again."""
        self._next_ns = None

    def forget(self) -> None:
        """The clock has jumped: nothing that is known is of this time."""
        self._history.clear()
        self._last = self._scan = self._straightened = self._end_ns = self._next_ns = None

    def add_odometry(self, odometry: Odometry) -> None:
        """Take in how the robot moves; where the pose jumps, what was seen before can no longer be carried on."""
        last = self._last
        if last is not None:
            passed_s = seconds_between(odometry.stamp_ns, last.stamp_ns)
            if passed_s <= 0.0:
                return
            moved = math.hypot(odometry.pose.x_m - last.pose.x_m, odometry.pose.y_m - last.pose.y_m)
            turned = abs(angle_difference(odometry.pose.yaw_rad, last.pose.yaw_rad))
            if moved > _JUMP_M + _JUMP_MPS * passed_s or turned > _JUMP_RAD + _JUMP_RADPS * passed_s:
                self._history.clear()
                self._scan = self._straightened = None
        self._last = odometry
        self._history.add(odometry)

    def add_scan(self, scan: LaserScan) -> None:
        """Take in a scan.

        Raises
        ------
        ScanRefused: if it is out of time, or too few of its beams say anything; what was known stays.
        """
        end_ns = scan.stamp_ns + to_nanoseconds(scan.time_increment_s * max(len(scan.ranges_m) - 1, 0))
        self._check_time(scan.stamp_ns, end_ns)
        ranges = np.where(np.isneginf(scan.ranges_m), scan.range_min_m, scan.ranges_m)  # too close is close
        says = np.isposinf(ranges) | ((ranges >= scan.range_min_m) & (ranges <= scan.range_max_m))
        if not len(ranges) or says.mean() < self._settings.least_measured:
            raise ScanRefused("too few beams measured anything")
        self._scan, self._straightened = replace(scan, ranges_m=ranges), None
        self._stamp_ns, self._end_ns = scan.stamp_ns, end_ns
        period_ns = to_nanoseconds(scan.scan_time_s)
        complete_ns = scan.stamp_ns + (period_ns if scan.time_increment_s > 0.0 else 0)
        self._next_ns = complete_ns + period_ns if period_ns > 0 else None

    def age_s(self, now_ns: int) -> float:
        """Age of the newest scan's last beam; infinite without one."""
        return math.inf if self._end_ns is None else max(seconds_between(now_ns, self._end_ns), 0.0)

    def points(self, now_ns: int) -> Array | str:
        """Points (n, 2) in the base's frame as of ``now_ns``; or why there are none to go by, in words."""
        if self._end_ns is None:
            return "no scan yet"
        age_s = self.age_s(now_ns)
        if age_s > self._settings.scan_timeout_s:
            return f"the scan is older than {self._settings.scan_timeout_s:g} s"
        seen = self._seen()
        poses = None if seen is None else self._history.at(np.array([seen.stamp_ns, now_ns], np.int64))
        if seen is None or poses is None:
            return "the odometry does not reach back to the scan"
        (x, y, yaw), (now_x, now_y, now_yaw) = poses.tolist()
        return _seen_from(seen.hits, (x - now_x, y - now_y), yaw, now_yaw)

    def _seen(self) -> ScanPoints | None:
        """What the scan saw. Until the odometry has reached its end, this is made up from how the robot moved."""
        if self._straightened is not None or self._scan is None:
            return self._straightened
        seen = scan_points(self._scan, self._settings.lidar, self._history)
        newest_ns = self._history.newest_ns
        if newest_ns is not None and self._end_ns is not None and newest_ns >= self._end_ns:
            self._straightened = seen
        return seen

    def _check_time(self, stamp_ns: int, end_ns: int) -> None:
        now_ns = None if self._last is None else self._last.stamp_ns
        if now_ns is not None:
            if self._end_ns is not None and self._stamp_ns > now_ns + _FUTURE_NS:
                self._scan = self._straightened = self._end_ns = self._next_ns = None  # came before there was a clock
            if stamp_ns > now_ns + _FUTURE_NS:
                raise ScanRefused("stamp in the future")
            if seconds_between(now_ns, end_ns) > self._settings.scan_timeout_s:
                raise ScanRefused("stale stamp")
        if self._end_ns is not None and stamp_ns <= self._stamp_ns:
            raise ScanRefused("stamp repeated or out of order")


def _seen_from(points: Array, shift: tuple[float, float], yaw: float, now_yaw: float) -> Array:
    """Points of the base's frame at one pose, in its frame at a later one; ``shift`` leads back to the first."""
    cosine, sine = math.cos(yaw - now_yaw), math.sin(yaw - now_yaw)
    back_c, back_s = math.cos(-now_yaw), math.sin(-now_yaw)
    turned: Array = points @ np.array([[cosine, sine], [-sine, cosine]])
    turned += np.array([back_c * shift[0] - back_s * shift[1], back_s * shift[0] + back_c * shift[1]])
    return turned
