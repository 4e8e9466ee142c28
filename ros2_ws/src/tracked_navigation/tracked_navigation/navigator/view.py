"""What the lidar shows, sorted: of the map, standing about unmapped, and moving."""

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.movers.map_mask import MapMask
from tracked_navigation.movers.mover_tracker import MoverSettings, MoverTracker
from tracked_navigation.navigator.unmapped import UnmappedObstacles, bare_walls, without_near
from tracked_types import Mover, OccupancyMap, Pose2, ScanPoints

Array = NDArray[np.float64]
_OF_WALL_M = 0.15  # points so near to something of the map are of it
_OF_MOVER_M = 0.15  # points so near to a mover's disc are of it
_STANDING_MPS = 0.12


class View:
    """Everything in the map's frame, as of the newest scan."""

    def __init__(self, occupancy_map: OccupancyMap, movers: MoverSettings, frame_id: str, remember_s: float) -> None:
        self._map, self._remember_s = occupancy_map, remember_s
        self._mask = MapMask(occupancy_map, _OF_WALL_M)
        self._walls = bare_walls(occupancy_map)
        self._tracker = MoverTracker(movers, frame_id)
        self.forget()

    def forget(self) -> None:
        """The robot is elsewhere, or the clock was set back."""
        self._tracker.restart()
        self._unmapped = UnmappedObstacles(self._map, self._remember_s)
        self._hits = np.zeros((0, 2))
        self.movers: tuple[Mover, ...] = ()
        self.stamp_ns: int | None = None

    def add(self, points: ScanPoints, pose: Pose2) -> None:
        """Take in one scan; ``pose`` is that of the base at its stamp."""
        hits, misses = pose.transform(points.hits), pose.transform(points.misses)
        news = hits[self._mask.unexplained(hits)]
        self.movers = self._tracker.update(news, points.stamp_ns)
        origin = pose.transform(np.array([points.origin]))[0]
        self._unmapped.add(self._not_moving(news), np.concatenate([hits, misses]), origin, points.stamp_ns)
        self._hits = self._not_moving(hits)
        self.stamp_ns = points.stamp_ns

    def obstacles_around(self, pose: Pose2, reach_m: float) -> Array:
        """Points (n, 2) that stand: seen now, remembered, or of the map where the lidar does not look."""
        hits = _within(self._hits, pose, reach_m)
        hidden = [_within(points, pose, reach_m) for points in (self._unmapped.points, self._walls)]
        return np.concatenate([hits, *(without_near(points, hits, _OF_WALL_M) for points in hidden)])

    @property
    def unmapped(self) -> Array:
        """Points (n, 2) that the map lacks and that will stay for now; movers that stand are among them."""
        standing = [mover.rim for mover in self.movers if np.hypot(*mover.velocity_mps) < _STANDING_MPS]
        return np.concatenate([self._unmapped.points, *standing])

    def _not_moving(self, points: Array) -> Array:
        for mover in self.movers:
            away = np.hypot(*(points - mover.position_m).T)
            points = points[away > mover.radius_m + _OF_MOVER_M]
        return points


def _within(points: Array, pose: Pose2, reach_m: float) -> Array:
    near: Array = points[np.hypot(points[:, 0] - pose.x_m, points[:, 1] - pose.y_m) <= reach_m]
    return near
