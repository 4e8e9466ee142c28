"""A map of an unknown place while driving: each scan is laid over what is mapped so far, then added to it."""

from dataclasses import dataclass

import numpy as np

from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.matching.scan_matcher import Match, MatchSettings, match_scan
from tracked_localization.matching.wall_field import WallField
from tracked_types import OccupancyMap, Pose2, wrap_angle
from tracked_types.scan_points import ScanPoints
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class MapperSettings:
    """How far a match may lead, and how often the map it is laid over is renewed."""

    most_correction_m: float = setting(
        0.5, "a match farther than this from where odometry says is not believed", unit="m", low=0.01, high=10.0
    )
    most_correction_rad: float = setting(
        0.35,
        "a match turned by more than this from where odometry says is not believed",
        unit="rad",
        low=0.01,
        high=3.0,
    )
    match_radius_m: float = setting(
        16.0, "what is farther from the robot is mapped, but not matched", unit="m", low=1.0, high=100.0
    )
    renewal_distance_m: float = setting(
        0.5, "the map to match with is made anew after so much driving", unit="m", low=0.01, high=10.0
    )
    renewal_turn_rad: float = setting(
        0.2, "the map to match with is made anew after so much turning", unit="rad", low=0.01, high=3.0
    )

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True, slots=True)
class Placed:
    """Where a scan was put. match: None while there is nothing to match with, or if the match was not believed."""

    pose: Pose2
    match: Match | None
    reason: str = ""


class Mapper:
    """Keeps the map and the pose of the odometry's frame in it.

    ``start``: pose of the base in the map's frame at the first scan.
    """

    def __init__(
        self,
        settings: MapperSettings,
        grid: LogOddsSettings,
        matching: MatchSettings,
        frame_id: str = "map",
        start: Pose2 | None = None,
    ) -> None:
        self._settings, self._matching = settings, matching
        self.grid = LogOddsGrid(grid, frame_id)
        self._field: WallField | None = None
        self._renewed_at: Pose2 | None = None
        self._start = start or Pose2(0.0, 0.0, 0.0)
        self.odom_in_map: Pose2 | None = None

    def add(self, points: ScanPoints, odom_pose: Pose2) -> Placed:
        """Place one scan and add it to the map; ``odom_pose`` is the base in the odometry's frame at its instant.

        A scan whose match is not believed is added where odometry says: the robot has turned into the unknown.

        Raises
        ------
        MapTooLargeError: the map is left as it was.
        """
        if self.odom_in_map is None:
            self.odom_in_map = self._start.compose(odom_pose.inverse())
        guess = self.odom_in_map.compose(odom_pose)
        match, reason = None, "nothing mapped yet"
        if self._field is not None:
            near = np.hypot(points.hits[:, 0], points.hits[:, 1]) < self._settings.match_radius_m
            match = match_scan(self._field, points.hits[near], guess, self._matching)
            reason = self._doubt(match, guess)
        pose = guess
        if match is not None and not reason:
            pose = match.pose
            self.odom_in_map = pose.compose(odom_pose.inverse())
        self.grid.add(points, pose)
        self._renew(pose)
        return Placed(pose, None if reason else match, reason)

    def go_on_with(self, grid: LogOddsGrid, odom_in_map: Pose2 | None = None) -> None:
        """Match with, and add to, another grid from now on; the odometry's frame may have moved in the map."""
        self.grid = grid
        self._renewed_at = None
        if odom_in_map is not None:
            self.odom_in_map = odom_in_map

    def as_map(self) -> OccupancyMap:
        """The map so far."""
        return self.grid.as_map()

    def _doubt(self, match: Match, guess: Pose2) -> str:
        settings, doubt = self._settings, match.doubt(self._matching)
        if doubt:
            return doubt
        distance_m = float(np.hypot(match.pose.x_m - guess.x_m, match.pose.y_m - guess.y_m))
        turn_rad = abs(wrap_angle(match.pose.yaw_rad - guess.yaw_rad))
        if distance_m > settings.most_correction_m or turn_rad > settings.most_correction_rad:
            return f"the scan fits {distance_m:.2f} m and {turn_rad:.2f} rad from where odometry says"
        return ""

    def _renew(self, pose: Pose2) -> None:
        settings, last = self._settings, self._renewed_at
        if last is not None:
            near = np.hypot(pose.x_m - last.x_m, pose.y_m - last.y_m) < settings.renewal_distance_m
            if near and abs(wrap_angle(pose.yaw_rad - last.yaw_rad)) < settings.renewal_turn_rad:
                return
        try:
            self._field = WallField(self.grid.as_map(pose, settings.match_radius_m))
        except ValueError:  # nothing is occupied yet
            return
        self._renewed_at = pose
