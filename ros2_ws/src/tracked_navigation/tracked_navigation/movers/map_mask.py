"""Which points the map explains: those on or near what it shows as occupied, and those where it shows nothing."""

import cv2
import numpy as np
from numpy.typing import NDArray

from tracked_types import UNKNOWN, OccupancyMap


class MapMask:
    """Answers for one map; ``reach_m`` is how far from a wall a point may lie and still be of the wall."""

    def __init__(self, occupancy_map: OccupancyMap, reach_m: float) -> None:
        self._map = occupancy_map
        explaining = occupancy_map.occupied | (occupancy_map.occupancy == UNKNOWN)
        free = (~explaining).astype(np.uint8)
        near = np.zeros(free.shape, np.bool_)
        if explaining.any():
            distance = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
            near = np.asarray(distance * occupancy_map.resolution_m <= reach_m, np.bool_)
        self._explained = near

    def unexplained(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether each of the points (n, 2) of the map's frame is news; what lies outside the map is not."""
        row, column, inside = self._map.look_up(points)
        news: NDArray[np.bool_] = inside & ~self._explained[row, column]
        return news
