"""Where the odometry's frame lies in the map while the odometry itself follows the scans.

The odometry filter fuses what the scans measure, so that its frame need not move in the map: it is pinned once the
robot is known to be where the map says, and scans become measurements in the odometry's own frame.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_localization.matching.information import rotation
from tracked_types import Pose2, PoseSample, seconds_between, wrap_angle
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]
_UNSEEN = 1e-3  # information (1/m2, 1/rad2) in directions that a scan does not show: 32 m, 32 rad


@dataclass(frozen=True, slots=True, kw_only=True)
class AnchorSettings:
    """When the odometry is taken to have left for good."""

    anchor_tolerance_m: float = setting(
        0.15, "the odometry's frame is pinned anew if the scans place the robot farther off", unit="m", low=0.01
    )
    anchor_tolerance_rad: float = setting(
        0.1, "the odometry's frame is pinned anew if the scans turn the robot farther", unit="rad", low=0.001
    )
    anchor_patience_s: float = setting(
        2.0, "for so long the odometry may be off before its frame is pinned anew", unit="s", low=0.0, high=60.0
    )

    def __post_init__(self) -> None:
        check_settings(self)


class OdometryAnchor:
    """Pinned, loose, and pinned anew where the odometry does not follow."""

    def __init__(self, settings: AnchorSettings) -> None:
        self._settings = settings
        self._agreed_ns: int | None = None
        self.odom_in_map: Pose2 | None = None

    def loosen(self) -> None:
        """The robot is not where it was thought to be."""
        self.odom_in_map = None

    def pin(self, odom_in_map: Pose2, stamp_ns: int) -> None:
        """The odometry's frame lies here."""
        self.odom_in_map, self._agreed_ns = odom_in_map, stamp_ns

    def check(self, pose: Pose2, odom_pose: Pose2, stamp_ns: int) -> bool:
        """Compare where a scan and where the odometry has the robot; whether the frame had to be pinned anew."""
        if self.odom_in_map is None:
            return False
        followed, settings = self.odom_in_map.compose(odom_pose), self._settings
        distance_m = math.hypot(pose.x_m - followed.x_m, pose.y_m - followed.y_m)
        turn_rad = abs(wrap_angle(pose.yaw_rad - followed.yaw_rad))
        near = distance_m <= settings.anchor_tolerance_m and turn_rad <= settings.anchor_tolerance_rad
        if near or self._agreed_ns is None or stamp_ns < self._agreed_ns:
            self._agreed_ns = stamp_ns
        if seconds_between(stamp_ns, self._agreed_ns) < settings.anchor_patience_s or near:
            return False
        self.pin(pose.compose(odom_pose.inverse()), stamp_ns)
        return True

    def measured(self, pose: Pose2, information: Array, stamp_ns: int, odom_frame: str) -> PoseSample | None:
        """A pose in the map with its information (3, 3) as a measurement in the odometry's frame."""
        if self.odom_in_map is None:
            return None
        inward = self.odom_in_map.inverse()
        turned = rotation(inward.yaw_rad)
        covariance = np.linalg.inv(information + _UNSEEN * np.eye(3))
        covariance = turned @ covariance @ turned.T
        return PoseSample(stamp_ns, odom_frame, inward.compose(pose), 0.5 * (covariance + covariance.T))
