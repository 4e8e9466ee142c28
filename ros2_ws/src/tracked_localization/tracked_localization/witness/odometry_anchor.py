"""The pose by scans in the frame of the odometry, for the filter that makes that odometry."""

import math

import numpy as np

from tracked_localization.matching.information import rotation
from tracked_localization.witness.scan_motion import ScanStep
from tracked_types import Odometry, Pose2, PoseHistory, PoseSample

_JUMP_M, _JUMP_RAD = 0.2, 0.3
_LEAST_VARIANCE = np.diag([1e-6, 1e-6, 1e-6])


class OdometryAnchor:
    """Fastens the way by scans to the odometry once, where it begins; from then on scans lead and odometry follows.

    When either begins anew, or the odometry jumps, it is fastened again.
    """

    def __init__(self) -> None:
        self._history = PoseHistory()
        self._last: Pose2 | None = None
        self._anchor: Pose2 | None = None

    def release(self) -> None:
        """Fasten anew with the next scan."""
        self._anchor = None

    def add_odometry(self, odometry: Odometry) -> None:
        """Note where the odometry is."""
        if self._last is not None:
            step = self._last.inverse().compose(odometry.pose)
            if math.hypot(step.x_m, step.y_m) > _JUMP_M or abs(step.yaw_rad) > _JUMP_RAD:
                self._history.clear()
                self.release()
        self._last = odometry.pose
        self._history.add(odometry)

    def pose(self, step: ScanStep, frame_id: str) -> PoseSample | None:
        """The scan's pose in the odometry's frame; None as long as the odometry at its instant is not known."""
        if self._anchor is None:
            found = self._history.at(np.array([step.stamp_ns], np.int64))
            if found is None:
                return None
            self._anchor = Pose2(*found[0].tolist()).compose(step.pose.inverse())
        turn = rotation(self._anchor.yaw_rad)
        covariance = turn @ step.covariance @ turn.T + _LEAST_VARIANCE
        return PoseSample(step.stamp_ns, frame_id, self._anchor.compose(step.pose), covariance)
