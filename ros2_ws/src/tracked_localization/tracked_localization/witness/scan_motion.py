"""Motion of the robot from scan to scan, each laid over a scan of a moment ago that serves as the map."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_localization.matching.information import corrected, offset_to, posterior_of, rotation, with_floor
from tracked_localization.matching.scan_matcher import Match, MatchSettings, match_scan
from tracked_localization.witness.scan_field import ScanField
from tracked_types import Pose2, ScanPoints
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]
_UNSEEN_VARIANCE = 1.0  # m^2, rad^2: of what a scan alone says along a direction that it does not show


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanMotionSettings:
    """When a scan becomes the new key scan, and how far matches are believed."""

    key_distance_m: float = setting(0.3, "a new key scan is taken after so much driving", unit="m", low=0.02, high=10.0)
    key_turn_rad: float = setting(0.4, "a new key scan is taken after so much turning", unit="rad", low=0.02, high=3.0)
    scan_match_scale_m: float = setting(
        0.02, "distance from the key scan at which a point counts half", unit="m", low=0.001, high=1.0
    )
    scan_match_reach_m: float = setting(
        0.3, "points farther than this from the key scan say nothing", unit="m", low=0.01, high=5.0
    )
    scan_match_agreement: float = setting(
        0.4, "share of a scan's points that must lie on the key scan", low=0.0, high=1.0
    )
    scan_match_floor_m: float = setting(
        0.001, "standard deviation of a match that more points do not make smaller", unit="m", low=1e-5, high=0.1
    )
    scan_match_floor_rad: float = setting(0.0006, "the same of its heading", unit="rad", low=1e-5, high=0.1)

    def __post_init__(self) -> None:
        check_settings(self)

    def matching(self) -> MatchSettings:
        """Settings of the matcher."""
        return MatchSettings(
            match_reach_m=self.scan_match_reach_m,
            match_scale_m=self.scan_match_scale_m,
            match_deviation_m=0.003,
            match_agreement=self.scan_match_agreement,
        )


@dataclass(frozen=True, slots=True)
class ScanStep:
    """What one scan says.

    pose, covariance: of the base (x, y, yaw; 3, 3) since the first scan, with what scans do not show taken from the
    belts and the gyro; the covariance only grows. step, step_covariance: motion since the scan before it, in the base's
    frame then, by scans alone, None if they do not say; variance about one along directions that they do not show.
    """

    stamp_ns: int
    pose: Pose2
    covariance: Array
    step: Pose2 | None
    step_covariance: Array
    match: Match | None
    reason: str


class ScanMotion:
    """Scan to key scan, key scan to key scan."""

    def __init__(self, settings: ScanMotionSettings) -> None:
        self._settings = settings
        self._matching = settings.matching()
        self._floor = np.diag(
            np.square([settings.scan_match_floor_m, settings.scan_match_floor_m, settings.scan_match_floor_rad])
        )
        self.restart()

    def restart(self) -> None:
        """Begin anew: pose zero at the next scan."""
        self._field: ScanField | None = None
        self._key = Pose2(0.0, 0.0, 0.0)
        self._key_covariance = np.zeros((3, 3))
        self._pose = Pose2(0.0, 0.0, 0.0)
        self._covariance = np.zeros((3, 3))
        self._seen: tuple[Pose2, Array] | None = None

    def add(self, points: ScanPoints, motion: Pose2, motion_covariance: Array) -> ScanStep:
        """Take one scan in; ``motion`` since the one before it as belts and gyro have it, (3, 3) its covariance."""
        if self._field is None:
            self._renew(points)
            return self._result(points, None, None, "the first scan")
        guess = self._pose.compose(motion)
        self._covariance = _composed(self._pose, self._covariance, motion, motion_covariance)
        match = match_scan(self._field, points.hits, guess, self._matching)
        reason = match.doubt(self._matching)
        self._pose = guess
        settings, step = self._settings, None
        if not reason:
            information = with_floor(match.information, settings.scan_match_floor_m, settings.scan_match_floor_rad)
            self._correct(match.pose, information)
            step = self._since_last(match.pose, information)
        else:
            self._seen = None
        result = self._result(points, step, match, reason)
        far = math.hypot(self._pose.x_m, self._pose.y_m) > settings.key_distance_m
        if reason or far or abs(self._pose.yaw_rad) > settings.key_turn_rad:
            self._renew(points)
        return result

    def _correct(self, seen: Pose2, information: Array) -> None:
        posterior = posterior_of(self._covariance, information)
        offset = offset_to(seen, self._pose)
        self._pose, self._covariance = corrected(self._pose, offset, information, posterior)

    def _since_last(self, seen: Pose2, information: Array) -> tuple[Pose2, Array] | None:
        """Motion since the scan before, in the frame of the base then."""
        unseen = np.diag(np.full(3, 1.0 / _UNSEEN_VARIANCE))
        alone = np.asarray(np.linalg.inv(information + unseen), np.float64)
        before, self._seen = self._seen, (seen, alone)
        if before is None:
            return None
        step = before[0].inverse().compose(seen)
        turn = rotation(-before[0].yaw_rad)
        return step, turn @ (alone + before[1]) @ turn.T

    def _renew(self, points: ScanPoints) -> None:
        self._key_covariance = _composed(self._key, self._key_covariance, self._pose, self._covariance)
        self._key = self._key.compose(self._pose)
        self._field = ScanField(points.hits)
        self._pose, self._covariance = Pose2(0.0, 0.0, 0.0), np.zeros((3, 3))
        self._seen = (self._pose, self._floor.copy())

    def _result(
        self, points: ScanPoints, step: tuple[Pose2, Array] | None, match: Match | None, reason: str
    ) -> ScanStep:
        return ScanStep(
            points.stamp_ns,
            self._key.compose(self._pose),
            _composed(self._key, self._key_covariance, self._pose, self._covariance),
            None if step is None else step[0],
            np.zeros((3, 3)) if step is None else step[1],
            match,
            reason,
        )


def _composed(first: Pose2, first_covariance: Array, second: Pose2, second_covariance: Array) -> Array:
    """Covariance (3, 3) of ``first.compose(second)``."""
    placed = first.compose(second)
    carry = np.eye(3)
    carry[0, 2], carry[1, 2] = first.y_m - placed.y_m, placed.x_m - first.x_m
    turn = rotation(first.yaw_rad)
    total = carry @ first_covariance @ carry.T + turn @ second_covariance @ turn.T
    symmetric: Array = 0.5 * (total + total.T)
    return symmetric
