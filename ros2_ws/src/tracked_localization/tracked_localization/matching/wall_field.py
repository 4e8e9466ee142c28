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
_REACH = 2  # cells to each side that the fit of a wall takes in
_OFFSETS = np.array([(x, y) for y in range(-_REACH, _REACH + 1) for x in range(-_REACH, _REACH + 1)], np.float64)
_PRODUCTS = np.einsum("ki,kj->kij", _OFFSETS, _OFFSETS).reshape(-1, 4)
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
    """Middle (n, 2) and normal (n, 2), NaN where there is none, of the wall around each occupied cell.

    A thin wall that was seen from both sides has two faces. A cell is fitted with those around it that face the same
    way, that is, have what is free on the same side.
    """
    weight = _around(np.where(occupied, occupancy_map.occupancy / 100.0, 0.0), cells)
    vacant = (occupancy_map.occupancy >= 0) & ~occupied
    facing = np.zeros((2, *occupied.shape))
    facing[:, cells[:, 0], cells[:, 1]] = _OFFSETS.T @ _around(vacant.astype(np.float64), cells).T
    own: Array = facing[:, cells[:, 0], cells[:, 1]]
    alike = own[0, :, None] * _around(facing[0], cells) + own[1, :, None] * _around(facing[1], cells) > 0.0
    faceless = (own == 0.0).all(axis=0)
    weight = weight * (alike | np.asarray(faceless)[:, None])
    total = weight.sum(axis=1)
    centre = weight @ _OFFSETS / total[:, None]
    squares = weight @ _PRODUCTS / total[:, None] - np.einsum("ni,nj->nij", centre, centre).reshape(-1, 4)
    variances, directions = np.linalg.eigh(squares.reshape(-1, 2, 2))
    normal = directions[:, :, 0]
    # The local frame of the grid may be turned in the map's frame.
    turn = occupancy_map.origin.yaw_rad
    normal = normal @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    straight = (variances[:, 1] > 0.5) & (variances[:, 0] < _STRAIGHT * variances[:, 1])
    places = cells[:, ::-1] + centre
    middle = occupancy_map.origin.transform((places + 0.5) * occupancy_map.resolution_m)
    # Round corners the fit leaves the wall: there the cell itself says where it is.
    return (
        np.where(straight[:, None], middle, occupancy_map.centres_of(cells)),
        np.where(straight[:, None], normal, np.nan),
    )


def _around(values: Array, cells: NDArray[np.intp]) -> Array:
    """Values (n, 25) of the cells around each of the cells, in the order of the offsets; zero beyond the edge."""
    padded = np.pad(values, _REACH)
    row, column = cells[:, :1] + _REACH, cells[:, 1:] + _REACH
    found: Array = padded[row + _OFFSETS[:, 1].astype(np.intp), column + _OFFSETS[:, 0].astype(np.intp)]
    return found
