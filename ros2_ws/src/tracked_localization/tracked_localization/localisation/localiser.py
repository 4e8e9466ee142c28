"""Follows the robot on a known map: odometry carries the pose on, scans correct it as far as they show it."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_localization.matching.information import corrected, offset_to, posterior_of, with_floor
from tracked_localization.matching.scan_matcher import Match, MatchSettings, match_scan
from tracked_localization.matching.wall_field import WallField
from tracked_types import Pose2, seconds_between
from tracked_types.scan_points import ScanPoints
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class LocaliserSettings:
    """How odometry drifts, and when a scan contradicts the pose."""

    drift_m_per_m: float = setting(0.1, "standard deviation of odometry per metre driven", unit="m", low=1e-4, high=2.0)
    drift_rad_per_rad: float = setting(
        0.05, "standard deviation of odometry's heading per radian turned", unit="rad", low=1e-4, high=2.0
    )
    drift_rad_per_m: float = setting(
        0.02, "standard deviation of odometry's heading per metre driven", unit="rad", low=1e-4, high=2.0
    )
    surprise: float = setting(
        3.0,
        "a scan that fits more standard deviations away than this is not believed; when others after it agree, "
        "odometry was worse than thought: the pose becomes less sure until they fit",
        low=1.0,
        high=100.0,
    )
    surprising_scans: int = setting(4, "so many surprising scans one after the other are believed", low=1, high=100)
    lost_after_s: float = setting(
        1.0, "without a usable scan for this long the robot is lost", unit="s", low=0.1, high=60.0
    )
    scan_deviation_m: float = setting(
        0.01, "standard deviation of a match that more points do not make smaller", unit="m", low=1e-4, high=1.0
    )
    scan_deviation_rad: float = setting(
        0.004,
        "standard deviation of a match's heading that more points do not make smaller",
        unit="rad",
        low=1e-5,
        high=1.0,
    )
    scan_strangeness: float = setting(
        0.15,
        "share of a scan off the map that doubles these two deviations; they grow with its square, since what is not "
        "on the map, as the floor before a pitching robot, also pulls at the rest",
        low=0.01,
        high=1.0,
    )

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True, slots=True)
class Localised:
    """The robot on the map as of one scan.

    pose: of the base in the map's frame. covariance: of x, y, yaw (3, 3). odom_in_map: the odometry's frame in the map.
    match: what the scan said. used: whether it corrected the pose; reason: why not. lost: nothing has fitted for long.
    """

    stamp_ns: int
    pose: Pose2
    covariance: Array
    odom_in_map: Pose2
    match: Match
    used: bool
    reason: str
    lost: bool


class Localiser:
    """Keeps the pose of the odometry's frame in the map, and how sure it is.

    start: the base in the map's frame at the first scan; covariance: of it, (3, 3).
    """

    def __init__(
        self,
        settings: LocaliserSettings,
        matching: MatchSettings,
        field: WallField,
        start: Pose2,
        covariance: Array | None = None,
    ) -> None:
        self._settings, self._matching, self._field = settings, matching, field
        self.restart(start, covariance)

    def restart(self, pose: Pose2, covariance: Array | None = None) -> None:
        """The base is at ``pose``: somebody says so.

        Raises
        ------
        ValueError: if pose or covariance are not finite, or the covariance is not positive definite.
        """
        spread = np.diag([0.25, 0.25, 0.07]) if covariance is None else np.asarray(covariance, np.float64)
        if not np.isfinite(pose.as_array()).all() or spread.shape != (3, 3) or not np.isfinite(spread).all():
            raise ValueError(f"pose and covariance (3, 3) must be finite, got {pose} and {spread.tolist()}")
        if np.abs(spread - spread.T).max() > 1e-9 or np.linalg.eigvalsh(spread).min() <= 0.0:
            raise ValueError(f"the covariance must be symmetric and positive definite, got {spread.tolist()}")
        self._pose, self._covariance = pose, spread
        self._odom_pose: Pose2 | None = None
        self._surprises = 0
        self._used_ns: int | None = None

    @property
    def pose(self) -> Pose2:
        """The base in the map's frame as of the last scan."""
        return self._pose

    def add(self, points: ScanPoints, odom_pose: Pose2, expected: Pose2 | None = None) -> Localised:
        """Take one scan in; ``odom_pose`` is the base in the odometry's frame at its instant.

        expected: the base in the map's frame as somebody has it who knows of the scans before; by default as odometry
        has moved since the last one.
        """
        self._carry_on(odom_pose)
        if expected is not None:
            self._pose = expected
        if self._used_ns is None or points.stamp_ns < self._used_ns:
            self._used_ns = points.stamp_ns
        match = match_scan(self._field, points.hits, self._pose, self._matching)
        reason = self._correct(match)
        if not reason:
            self._used_ns = points.stamp_ns
        lost = seconds_between(points.stamp_ns, self._used_ns) >= self._settings.lost_after_s
        odom_in_map = self._pose.compose(odom_pose.inverse())
        return Localised(points.stamp_ns, self._pose, self._covariance, odom_in_map, match, not reason, reason, lost)

    def information(self, match: Match) -> Array:
        """What a match tells of x, y and yaw, (3, 3) in the map's axes; nothing of what the scan does not show.

        Points of one scan err together, so that their information has an end.
        """
        settings = self._settings
        growth = 1.0 + ((1.0 - match.agreement) / settings.scan_strangeness) ** 2
        return with_floor(match.information, growth * settings.scan_deviation_m, growth * settings.scan_deviation_rad)

    def _carry_on(self, odom_pose: Pose2) -> None:
        """Move as odometry moved, and grow less sure by it."""
        before, self._odom_pose = self._odom_pose, odom_pose
        if before is None:
            return
        step = before.inverse().compose(odom_pose)
        settings = self._settings
        distance, turn = math.hypot(step.x_m, step.y_m), abs(step.yaw_rad)
        along = settings.drift_m_per_m * distance
        heading = math.hypot(settings.drift_rad_per_rad * turn, settings.drift_rad_per_m * distance)
        moved = self._pose.compose(step)
        carry = np.eye(3)
        carry[0, 2], carry[1, 2] = self._pose.y_m - moved.y_m, moved.x_m - self._pose.x_m
        self._covariance = carry @ self._covariance @ carry.T + np.diag([along**2, along**2, heading**2])
        self._pose = moved

    def _correct(self, match: Match) -> str:
        """Weigh the match against the carried pose; the reason if it is not used."""
        settings = self._settings
        doubt = match.doubt(self._matching)
        if doubt:
            return doubt
        offset, information = offset_to(match.pose, self._pose), self.information(match)
        posterior = posterior_of(self._covariance, information)
        # offset' (P + H^-1)^-1 offset, also where the information H is singular
        surprise = float(offset @ (np.eye(3) - information @ posterior) @ information @ offset)
        self._surprises = self._surprises + 1 if surprise > settings.surprise**2 else 0
        if 0 < self._surprises < settings.surprising_scans:
            return f"the scan fits {math.hypot(offset[0], offset[1]):.2f} m and {abs(offset[2]):.2f} rad from odometry"
        if self._surprises:
            self._covariance = self._covariance * (surprise / settings.surprise**2)
            posterior = posterior_of(self._covariance, information)
        self._pose, self._covariance = corrected(self._pose, offset, information, posterior)
        return ""
