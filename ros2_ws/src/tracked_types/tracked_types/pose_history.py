"""Where the base was, at any instant of the last moments."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from tracked_types.angles import angle_difference
from tracked_types.odometry import Odometry
from tracked_types.stamps import to_nanoseconds

Array = NDArray[np.float64]


class PoseHistory:
    """Poses and tilts of an odometry, interpolated in time; headings are continuous.

    length_s: how long poses are kept. reach_s: how far beyond the newest pose, or across a gap, one is still made up.
    """

    def __init__(self, length_s: float = 2.0, reach_s: float = 0.2) -> None:
        self._length_ns = to_nanoseconds(length_s)
        self._reach_ns = to_nanoseconds(reach_s)
        self._stamps_ns: deque[int] = deque()
        self._poses: deque[tuple[float, float, float]] = deque()
        self._tilts: deque[tuple[float, float]] = deque()
        self._twist = (0.0, 0.0)

    @property
    def newest_ns(self) -> int | None:
        """Stamp of the newest pose."""
        return self._stamps_ns[-1] if self._stamps_ns else None

    def clear(self) -> None:
        """Forget everything: the clock or the odometry has jumped."""
        self._stamps_ns.clear()
        self._poses.clear()
        self._tilts.clear()

    def add(self, odometry: Odometry) -> None:
        """Take a pose in; one that is not newer than the newest is ignored."""
        if self._stamps_ns and odometry.stamp_ns <= self._stamps_ns[-1]:
            return
        pose = odometry.pose
        yaw_rad = pose.yaw_rad
        if self._poses:
            yaw_rad = self._poses[-1][2] + angle_difference(yaw_rad, self._poses[-1][2])
        self._stamps_ns.append(odometry.stamp_ns)
        self._poses.append((pose.x_m, pose.y_m, yaw_rad))
        self._tilts.append((odometry.roll_rad, odometry.pitch_rad))
        self._twist = (odometry.twist.speed_mps, odometry.twist.yaw_rate_radps)
        while self._stamps_ns[0] < odometry.stamp_ns - self._length_ns:
            self._stamps_ns.popleft()
            self._poses.popleft()
            self._tilts.popleft()

    def tilt_at(self, stamp_ns: int) -> tuple[float, float]:
        """Roll and pitch (rad) at an instant, those of the nearest pose that is known; level if none is."""
        if not self._stamps_ns:
            return 0.0, 0.0
        return self._tilts[int(np.argmin(np.abs(np.array(self._stamps_ns, np.int64) - stamp_ns)))]

    def at(self, stamps_ns: NDArray[np.int64]) -> Array | None:
        """Poses (n, 3): x (m), y (m), continuous heading (rad); None if an instant is out of reach.

        Before the oldest pose the robot is taken to have been there; after the newest it goes on as it went.
        """
        if not self._stamps_ns:
            return None
        known_ns = np.array(self._stamps_ns, np.int64)
        poses = np.array(self._poses)
        first, last = int(stamps_ns.min()), int(stamps_ns.max())
        if first < known_ns[0] - self._reach_ns or last > known_ns[-1] + self._reach_ns:
            return None
        inside = known_ns[max(0, int(np.searchsorted(known_ns, first, "right")) - 1) :]
        if len(inside) > 1 and (np.diff(inside[: np.searchsorted(inside, last) + 1]) > self._reach_ns).any():
            return None
        base_ns = int(known_ns[0])
        times, wanted = (known_ns - base_ns) * 1e-9, (stamps_ns - base_ns) * 1e-9
        found = np.column_stack([np.interp(wanted, times, poses[:, axis]) for axis in range(3)])
        ahead = np.maximum(wanted - times[-1], 0.0)
        speed, yaw_rate = self._twist
        heading = poses[-1, 2] + 0.5 * ahead * yaw_rate
        found[:, 0] += ahead * speed * np.cos(heading)
        found[:, 1] += ahead * speed * np.sin(heading)
        found[:, 2] += ahead * yaw_rate
        return found
