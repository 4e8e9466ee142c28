"""A mapper that closes loops: the same to talk to as `Mapper`."""

import numpy as np
from numpy.typing import NDArray

from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.mapping.mapper import Mapper, MapperSettings, Placed
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_localization.pose_graph.loop_closer import Kept, LoopCloser
from tracked_localization.pose_graph.settings import LoopSettings
from tracked_types import OccupancyMap, Pose2, ScanPoints


class LoopClosingMapper:
    """Lays each scan over what was seen a short way from here; walls of long ago are met by the graph alone.

    Over the whole map, drift would pull scans to walls that are not theirs. When a loop closes, the map is drawn anew
    from the kept scans at their new poses, and the odometry's frame moves in it.

    Parameters as of `Mapper`. Everything is kept: memory grows with the way driven (6 kB for a scan of 360 beams).
    """

    def __init__(
        self,
        settings: MapperSettings,
        grid: LogOddsSettings,
        matching: MatchSettings,
        loops: LoopSettings | None = None,
        frame_id: str = "map",
        start: Pose2 | None = None,
    ) -> None:
        self._grid_settings, self._frame_id = grid, frame_id
        self._loop_settings = loops or LoopSettings()
        self._recent = Mapper(settings, grid, matching, frame_id, start)
        self.closer = LoopCloser(self._loop_settings, grid, matching)
        self.grid = LogOddsGrid(grid, frame_id)
        self.kept = Kept(kept=False)
        """What became of the newest scan."""
        self._since_forgetting = 0

    @property
    def odom_in_map(self) -> Pose2 | None:
        """The odometry's frame in the map; None before the first scan."""
        return self._recent.odom_in_map

    def add(self, points: ScanPoints, odom_pose: Pose2) -> Placed:
        """Place one scan and add it to the map; ``odom_pose`` is the base in the odometry's frame at its instant.

        Raises
        ------
        MapTooLargeError: the map is left as it was.
        """
        placed = self._recent.add(points, odom_pose)
        self.kept = self.closer.add(points, placed.pose, placed.match)
        if self.kept.closed:
            placed = Placed(self.closer.scans[-1].pose, placed.match, placed.reason)
            self.grid = self._drawn(np.ones(len(self.closer.scans), np.bool_))
            self._forget(placed.pose.compose(odom_pose.inverse()))
            return placed
        self.grid.add(points, placed.pose)
        if self.kept.kept:
            self._since_forgetting += 1
            if self._since_forgetting * self._loop_settings.key_distance_m > self._loop_settings.recent_m:
                self._forget(None)
        return placed

    def as_map(self) -> OccupancyMap:
        """The map so far."""
        return self.grid.as_map()

    def _forget(self, odom_in_map: Pose2 | None) -> None:
        """Match from now on with what is a short way from here."""
        self._since_forgetting = 0
        near = self.closer.ways_m() <= self._loop_settings.recent_m
        self._recent.go_on_with(self._drawn(near), odom_in_map)

    def _drawn(self, chosen: NDArray[np.bool_]) -> LogOddsGrid:
        """The ``chosen`` (n,) of the kept scans at their poses."""
        grid = LogOddsGrid(self._grid_settings, self._frame_id)
        for scan, drawn in zip(self.closer.scans, chosen, strict=True):
            if drawn:
                grid.add(scan.points, scan.pose)
        return grid
