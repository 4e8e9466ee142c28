"""Judges measured poses that come late, and fuses them at their own instants."""

import math
from collections import deque

import numpy as np

from tracked_localization.health import POSE, BlameList, Fault
from tracked_localization.pose_filter import PoseFilter
from tracked_localization.pose_memory import PoseMemory, Snapshot
from tracked_localization.settings import OdometryFilterSettings
from tracked_types import Pose2, PoseSample, angle_difference, seconds_between, to_nanoseconds, wrap_angle

_MOST_WAITING = 20
_ALIKE_M, _ALIKE_RAD = 0.2, 0.1


class PoseFusion:
    """Takes poses in any order of arrival; those ahead of the filter wait for it.

    A pose whose squared innovation is beyond the gate is refused and blamed. When refused poses agree with one another
    for ``pose_surrender_s``, it is the filter that is wrong: the robot was carried, or its belts dug in. It then moves
    to where they say.
    """

    def __init__(self, settings: OdometryFilterSettings, pose_filter: PoseFilter, blames: BlameList) -> None:
        self._settings, self._filter, self._blames = settings, pose_filter, blames
        self._waiting: list[PoseSample] = []
        self._taken: deque[int] = deque(maxlen=256)
        self._refused: tuple[int, Pose2] | None = None

    @property
    def _memory(self) -> PoseMemory:
        return self._filter.memory

    def restart(self) -> None:
        """A new time line begins."""
        self._waiting.clear()
        self._taken.clear()
        self._refused = None

    def add(self, sample: PoseSample, now_ns: int | None) -> None:
        """Take one pose in; ``now_ns`` is the newest stamp of any sensor."""
        problem = self._problem(sample)
        if problem is not None:
            self._blames.blame(POSE, problem, now_ns or sample.stamp_ns)
            return
        patience_s = self._settings.pose_patience_s
        if patience_s == 0.0:
            self._blames.count(POSE, "late")
            return
        self._filter.expect_poses()
        if now_ns is None or seconds_between(sample.stamp_ns, now_ns) > patience_s:
            self._blames.blame(POSE, Fault.BAD_STAMP, now_ns or sample.stamp_ns)
        elif sample.stamp_ns in self._taken:
            self._blames.count(POSE, "duplicate")
        elif len(self._waiting) == _MOST_WAITING:
            self._blames.count(POSE, "too many ahead of the sensors")
        else:
            self._taken.append(sample.stamp_ns)
            self._waiting.append(sample)
            self._waiting.sort(key=lambda waiting: waiting.stamp_ns)
        self.catch_up()

    def catch_up(self) -> None:
        """Fuse the poses that the filter has reached."""
        newest_ns = self._memory.newest_ns
        while newest_ns is not None and self._waiting and self._waiting[0].stamp_ns <= newest_ns:
            self._fuse(self._waiting.pop(0))

    def _problem(self, sample: PoseSample) -> Fault | None:
        if not np.isfinite(sample.pose.as_array()).all():
            return Fault.NOT_FINITE
        covariance = np.asarray(sample.covariance, np.float64)
        if covariance.shape != (3, 3) or not np.isfinite(covariance).all():
            return Fault.BAD_COVARIANCE
        if np.abs(covariance - covariance.T).max() > 1e-6 * np.abs(covariance).max():
            return Fault.BAD_COVARIANCE
        if np.linalg.eigvalsh(covariance).min() <= 0.0:
            return Fault.BAD_COVARIANCE
        return Fault.WRONG_FRAME if sample.frame_id != self._settings.odom_frame else None

    def _fuse(self, sample: PoseSample) -> None:
        oldest_ns = self._memory.oldest_ns
        if oldest_ns is None or sample.stamp_ns < oldest_ns:
            self._blames.count(POSE, "late")
            return
        snapshot = self._memory.nearest(sample.stamp_ns)
        # The pose as it would have been measured at the snapshot, a fraction of a period away.
        step = self._memory.pose_between(sample.stamp_ns).inverse().compose(snapshot.pose)
        measured = sample.pose.compose(step)
        innovation = np.array(
            [
                measured.x_m - snapshot.state[0],
                measured.y_m - snapshot.state[1],
                angle_difference(measured.yaw_rad, float(snapshot.state[2])),
            ]
        )
        variance = snapshot.covariance[:3, :3] + sample.covariance
        square = float(innovation @ np.linalg.solve(variance, innovation))
        if square > self._settings.pose_gate_chi_square:
            self._refuse(sample, snapshot, measured)
            return
        self._refused = None
        self._filter.correct_past(snapshot, innovation, variance)

    def _refuse(self, sample: PoseSample, snapshot: Snapshot, measured: Pose2) -> None:
        shift = measured.compose(snapshot.pose.inverse())
        self._blames.blame(POSE, Fault.JUMP, sample.stamp_ns)
        since_ns = sample.stamp_ns
        if self._refused is not None and _alike(shift, self._refused[1], snapshot.pose):
            since_ns = self._refused[0]
        if sample.stamp_ns - since_ns >= to_nanoseconds(self._settings.pose_surrender_s):
            self._blames.count(POSE, "followed after all")
            self._filter.move(shift, np.asarray(sample.covariance, np.float64))
            self._refused = None
        else:
            self._refused = (since_ns, shift)


def _alike(one: Pose2, other: Pose2, at: Pose2) -> bool:
    """Whether two moves of the odometry's frame take the robot to about the same place."""
    first, second = one.compose(at), other.compose(at)
    near = math.hypot(first.x_m - second.x_m, first.y_m - second.y_m) < _ALIKE_M
    return near and abs(wrap_angle(first.yaw_rad - second.yaw_rad)) < _ALIKE_RAD
