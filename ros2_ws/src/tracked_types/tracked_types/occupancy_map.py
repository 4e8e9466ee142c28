"""Occupancy of the ground plane on a grid."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types.pose import Pose2

UNKNOWN, FREE, OCCUPIED = -1, 0, 100
OCCUPIED_PERCENT = 65
"""From this chance on a cell counts as occupied, as in map_server's defaults."""


@dataclass(frozen=True, slots=True)
class OccupancyMap:
    """Grid of square cells in ``frame_id``.

    origin: pose of the outer corner of cell [0, 0]. occupancy: int8, shape (height, width), row along +y and
    column along +x of the origin; -1 is unknown, else the chance of being occupied in percent, 0 to 100.

    Raises
    ------
    ValueError: if the grid is not two-dimensional int8 or the resolution is not a positive number.
    """

    frame_id: str
    resolution_m: float
    origin: Pose2
    occupancy: NDArray[np.int8]

    def __post_init__(self) -> None:
        if self.occupancy.ndim != 2 or self.occupancy.dtype != np.int8:
            raise ValueError(
                f"occupancy must be int8 (height, width), got {self.occupancy.dtype} {self.occupancy.shape}"
            )
        if not 0.0 < self.resolution_m < float("inf"):
            raise ValueError(f"resolution_m must be positive and finite, got {self.resolution_m}")
        if not np.isfinite(self.origin.as_array()).all():
            raise ValueError(f"origin must be finite, got {self.origin}")

    def cells_of(self, points_m: NDArray[np.float64]) -> NDArray[np.intp]:
        """Row and column, (n, 2), of points (n, 2) of the map's frame; they may lie outside the grid."""
        along = self.origin.inverse().transform(points_m)
        return np.floor(along[:, ::-1] / self.resolution_m).astype(np.intp)

    @property
    def occupied(self) -> NDArray[np.bool_]:
        """Which cells count as occupied, (height, width)."""
        return self.occupancy >= OCCUPIED_PERCENT

    def look_up(self, points_m: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
        """Row (n,), column (n,) of points (n, 2) of the map's frame and whether they lie on it; (0, 0) where not."""
        cells = self.cells_of(points_m)
        inside = np.all((cells >= 0) & (cells < self.occupancy.shape), axis=1)
        row, column = np.where(inside[:, None], cells, 0).T
        return row, column, np.asarray(inside)

    def centres_of(self, cells: NDArray[np.intp]) -> NDArray[np.float64]:
        """Centres (n, 2) in the map's frame of cells (n, 2), each row and column."""
        along = (cells[:, ::-1].astype(np.float64) + 0.5) * self.resolution_m
        return self.origin.transform(along)

    def known_part(self) -> "OccupancyMap":
        """The smallest window with all known cells; the whole if none is known."""
        known = self.occupancy != UNKNOWN
        rows, columns = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
        if not len(rows):
            return self
        low = np.array([[columns[0], rows[0]]]) * self.resolution_m
        corner = self.origin.transform(low)[0]
        origin = Pose2(float(corner[0]), float(corner[1]), self.origin.yaw_rad)
        window = self.occupancy[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].copy()
        return OccupancyMap(self.frame_id, self.resolution_m, origin, window)
