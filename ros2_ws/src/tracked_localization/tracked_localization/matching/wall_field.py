"""The nearest piece of wall to each place of a map.

A wall that a grid shows one or two cells thick is a line through the middle of its cells: fitted to the cells
around, it is known far better than a cell, and its direction with it.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracked_types import OCCUPIED_PERCENT, OccupancyMap

Array = NDArray[np.float64]
_NEIGHBOURHOOD = 5  # cells
_STRAIGHT = 0.35  # of the variance across a wall to that along it


@dataclass(frozen=True, slots=True)
class Walls:
    """What lies nearest to n places.

    offset_m: signed distance along the normal, (n,). normal: unit vectors (n, 2) across the wall, or away from what is
    too small or too crooked to have a direction. distance_m: to the middle of that piece, (n,); inf outside the map.
    """

    offset_m: Array
    normal: Array
    distance_m: Array


class WallField:
    """Answers for places in the map's frame.

    Raises
    ------
    ValueError: if no cell of the map is occupied.
    """

    def __init__(self, occupancy_map: OccupancyMap) -> None:
        occupied = occupancy_map.occupied
        if not occupied.any():
            raise ValueError(f"no cell of the map is occupied by {OCCUPIED_PERCENT} % or more")
        self._map = occupancy_map
        vacant = (~occupied).astype(np.uint8)
        _, labels = cv2.distanceTransformWithLabels(vacant, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
        cells = np.argwhere(occupied)
        order = np.empty(int(labels.max()) + 1, np.intp)
        order[labels[cells[:, 0], cells[:, 1]]] = np.arange(len(cells))
        self._nearest = order[labels]
        self._middle, self._normal = _lines(occupancy_map, occupied, cells)

    def at(self, points: Array) -> Walls:
        """The nearest piece of wall to each of the ``points`` (n, 2)."""
        row, column, inside = self._map.look_up(points)
        nearest = self._nearest[row, column]
        away = points - self._middle[nearest]
        distance = np.hypot(away[:, 0], away[:, 1])
        normal = self._normal[nearest]
        directed = np.isfinite(normal[:, 0])
        radial = away / np.maximum(distance, 1e-9)[:, None]
        normal = np.where(directed[:, None], normal, radial)
        return Walls((away * normal).sum(axis=1), normal, np.where(inside, distance, np.inf))


def _lines(occupancy_map: OccupancyMap, occupied: NDArray[np.bool_], cells: NDArray[np.intp]) -> tuple[Array, Array]:
    """Middle (n, 2) and normal (n, 2), NaN where there is none, of the wall around each occupied cell."""
    weight = np.where(occupied, occupancy_map.occupancy / 100.0, 0.0)
    row, column = cells.T
    mean_row, mean_column = row.mean(), column.mean()
    up = np.arange(weight.shape[0])[:, None] - mean_row
    right = np.arange(weight.shape[1])[None, :] - mean_column

    def around(values: Array) -> Array:
        size = (_NEIGHBOURHOOD, _NEIGHBOURHOOD)
        blurred = cv2.boxFilter(values, cv2.CV_64F, size, normalize=False, borderType=cv2.BORDER_CONSTANT)
        found: Array = np.asarray(blurred, np.float64)[row, column]
        return found

    total = around(weight)
    centre_x, centre_y = around(weight * right) / total, around(weight * up) / total
    variance_x = around(weight * right**2) / total - centre_x**2
    variance_y = around(weight * up**2) / total - centre_y**2
    mixed = around(weight * right * up) / total - centre_x * centre_y
    spread = np.stack([np.stack([variance_x, mixed], -1), np.stack([mixed, variance_y], -1)], -2)
    variances, directions = np.linalg.eigh(spread)
    normal = directions[:, :, 0]
    # The local frame of the grid may be turned in the map's frame.
    turn = occupancy_map.origin.yaw_rad
    normal = normal @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    straight = (variances[:, 1] > 0.5) & (variances[:, 0] < _STRAIGHT * variances[:, 1])
    places = np.column_stack([centre_x + mean_column, centre_y + mean_row])
    middle = occupancy_map.origin.transform((places + 0.5) * occupancy_map.resolution_m)
    # Round corners the fit leaves the wall: there the cell itself says where it is.
    own = occupancy_map.centres_of(cells)
    return np.where(straight[:, None], middle, own), np.where(straight[:, None], normal, np.nan)
