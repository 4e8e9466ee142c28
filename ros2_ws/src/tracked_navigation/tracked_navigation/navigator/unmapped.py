"""What stands on the map's free floor although the map does not show it."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from tracked_types import OccupancyMap, to_nanoseconds

Array = NDArray[np.float64]
_SIGHTINGS = 3  # scans in which a cell must be hit before it is remembered
_BINS = 360
_BEHIND_M = 0.2  # a beam that ends so far behind a cell has passed it


class UnmappedObstacles:
    """Remembers cells of the map's grid that scans hit again and again, until a beam passes through them."""

    def __init__(self, occupancy_map: OccupancyMap, remember_s: float) -> None:
        self._map = occupancy_map
        self._remember_ns = to_nanoseconds(remember_s)
        self._sightings = np.zeros(occupancy_map.occupancy.shape, np.uint8)
        self._seen_ns = np.zeros(occupancy_map.occupancy.shape, np.int64)

    def add(self, unexplained: Array, ends: Array, origin: Array, stamp_ns: int) -> None:
        """Take in one scan: points (n, 2) that the map does not explain, all ends (m, 2) of its beams whether they hit
        or not, and where it was taken from, (2,); in the map's frame."""
        self._forget_what_beams_pass(ends, origin, stamp_ns)
        row, column, inside = self._map.look_up(unexplained)
        row, column = np.unique(np.stack([row[inside], column[inside]]), axis=1)
        self._sightings[row, column] = np.minimum(self._sightings[row, column] + 1, 2 * _SIGHTINGS)
        self._seen_ns[row, column] = stamp_ns

    @property
    def points(self) -> Array:
        """Centres (n, 2) of the remembered cells in the map's frame."""
        return self._map.centres_of(np.argwhere(self._sightings >= _SIGHTINGS))

    def _forget_what_beams_pass(self, ends: Array, origin: Array, stamp_ns: int) -> None:
        cells = np.argwhere(self._sightings > 0)
        if not len(cells):
            return
        row, column = cells.T
        gone = self._seen_ns[row, column] < stamp_ns - self._remember_ns
        if len(ends):
            reach = _reach_by_bearing(ends - origin)
            offset = self._map.centres_of(cells) - origin
            bins = _bearing_bins(offset)
            passed = reach[bins] > np.hypot(offset[:, 0], offset[:, 1]) + _BEHIND_M
            gone |= passed
        self._sightings[row[gone], column[gone]] = 0


def _bearing_bins(offsets: Array) -> NDArray[np.intp]:
    bearing = np.arctan2(offsets[:, 1], offsets[:, 0])
    return np.floor((bearing + np.pi) / (2.0 * np.pi) * _BINS).astype(np.intp) % _BINS


def _reach_by_bearing(offsets: Array) -> Array:
    """How far (bins,) beams are known to have gone by bearing: the shortest of each bin and its neighbours; 0 where
    there is none."""
    shortest = np.full(_BINS, np.inf)
    np.minimum.at(shortest, _bearing_bins(offsets), np.hypot(offsets[:, 0], offsets[:, 1]))
    around = np.minimum(np.minimum(np.roll(shortest, 1), shortest), np.roll(shortest, -1))
    return np.where(np.isfinite(around), around, 0.0)


def bare_walls(occupancy_map: OccupancyMap) -> Array:
    """Centres (n, 2) of the occupied cells that border on one that is not: what a robot may touch of the walls."""
    occupied = np.pad(occupancy_map.occupied, 1, constant_values=True)
    buried = occupied[:-2, 1:-1] & occupied[2:, 1:-1] & occupied[1:-1, :-2] & occupied[1:-1, 2:]
    return occupancy_map.centres_of(np.argwhere(occupancy_map.occupied & ~buried))


def without_near(points: Array, others: Array, reach_m: float) -> Array:
    """The ``points`` (n, 2) that have none of the ``others`` (m, 2) within ``reach_m``."""
    if not len(points) or not len(others):
        return points
    distance, _ = cKDTree(others).query(points, distance_upper_bound=reach_m)
    kept: Array = points[~np.isfinite(distance)]
    return kept
