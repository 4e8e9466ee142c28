"""A pose as scan matching in a known map gives it, made from the truth: no scan is matched here."""

import numpy as np
from numpy.random import SeedSequence

from tracked_description import Robot
from tracked_types import BodyState, PeriodGrid, Pose2, PoseSample, to_nanoseconds, wrap_angle

RATE_HZ = 10
LATENCY_S = 0.08
POSITION_M, HEADING_RAD = 0.01, 0.006
_STREAM = 0x706F7365  # keeps these draws apart from those that others make from the same seed


class LidarPose:
    """Samples of the true pose in the odometry's frame: 10 Hz, 80 ms late, white noise of 1 cm and 6 mrad.

    Parameters
    ----------
    start: pose of the odometry's frame in the world of the truth.
    """

    def __init__(self, robot: Robot, seed: int, start: Pose2) -> None:
        self._frame_id = robot.frames.odom
        self._to_odom = start.inverse()
        self._grid = PeriodGrid(RATE_HZ)
        self._generator = np.random.default_rng(SeedSequence([seed, _STREAM]))
        self._covariance = np.diag([POSITION_M**2, POSITION_M**2, HEADING_RAD**2])
        self.latency_ns = to_nanoseconds(LATENCY_S)

    def update(self, truth: BodyState) -> PoseSample | None:
        """The sample of this instant, to be known `latency_ns` later; None between the instants of the lidar."""
        if not self._grid.is_instant(truth.stamp_ns):
            return None
        x, y, yaw = self._generator.standard_normal(3).tolist()
        pose = self._to_odom.compose(truth.pose)
        measured = Pose2(
            pose.x_m + POSITION_M * x, pose.y_m + POSITION_M * y, wrap_angle(pose.yaw_rad + HEADING_RAD * yaw)
        )
        return PoseSample(truth.stamp_ns, self._frame_id, measured, self._covariance)
