"""The nearest piece of wall to any place, from the points of a single scan."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from tracked_localization.matching.wall_field import Walls

Array = NDArray[np.float64]
_NEIGHBOURS = 7
_APART_M = 0.3
_STRAIGHT = 0.1  # of the variance across a piece of wall to that along it
_LEAST_SPREAD_M2 = 1e-5


class ScanField:
    """Straight pieces of wall through the points of one scan and their neighbours, without a grid between.

    A grid would round the points to its cells; scans 0.1 s apart differ by less than one. Points whose neighbours do
    not lie on a line with them, or that have none, say nothing.

    Parameters
    ----------
    points: (n, 2), finite, in any frame; answers are in the same.
    """

    def __init__(self, points: Array) -> None:
        self._middle, self._normal = _pieces(points)
        self._tree = cKDTree(self._middle) if len(self._middle) else None

    @property
    def pieces(self) -> int:
        """How many pieces of wall there are."""
        return len(self._middle)

    def at(self, points: Array) -> Walls:
        """The nearest piece of wall to each of the ``points`` (n, 2)."""
        count = len(points)
        if self._tree is None or not count:
            return Walls(np.zeros(count), np.tile([1.0, 0.0], (count, 1)), np.full(count, np.inf))
        distance, nearest = self._tree.query(points)
        normal = self._normal[nearest]
        away = points - self._middle[nearest]
        return Walls((away * normal).sum(axis=1), normal, np.asarray(distance))


def _pieces(points: Array) -> tuple[Array, Array]:
    """Middles (m, 2) and unit normals (m, 2) of the pieces."""
    nothing = np.zeros((0, 2))
    if len(points) < _NEIGHBOURS:
        return nothing, nothing
    distance, index = cKDTree(points).query(points, k=_NEIGHBOURS)
    near = (distance < _APART_M).astype(np.float64)
    count = near.sum(axis=1)
    group = points[index]
    middle = (near[:, :, None] * group).sum(axis=1) / count[:, None]
    away = (group - middle[:, None]) * near[:, :, None]
    spread = np.einsum("nki,nkj->nij", away, away) / count[:, None, None]
    variances, directions = np.linalg.eigh(spread)
    straight = (count >= 4) & (variances[:, 1] > _LEAST_SPREAD_M2) & (variances[:, 0] < _STRAIGHT * variances[:, 1])
    return middle[straight], directions[straight, :, 0]
