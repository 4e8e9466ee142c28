"""Occupancy from many scans: log-odds per cell on a grid that grows with what is seen."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracked_types import UNKNOWN, OccupancyMap, Pose2
from tracked_types.scan_points import ScanPoints
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]
_SHIFT = 8  # fractional bits of the ends of drawn lines
_GROWTH_M = 4.0
_MOST_CELLS = 2**26


class MapTooLargeError(ValueError):
    """A scan lies so far away that the map would outgrow memory."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LogOddsSettings:
    """How fast cells make up their mind."""

    resolution_m: float = setting(0.05, "edge of a cell", unit="m", low=0.005, high=1.0)
    grid_shift_m: float = setting(
        0.0,
        "borders of cells lie so far from whole cells, along x and y; where walls lie on borders, noise decides which "
        "of two cells they end up in",
        unit="m",
        low=-1.0,
        high=1.0,
    )
    hit: float = setting(0.9, "log-odds that a returned beam adds to the cell it ends in", low=0.01, high=10.0)
    miss: float = setting(0.4, "log-odds that a beam takes from each cell it crosses", low=0.01, high=10.0)
    most: float = setting(
        3.5,
        "bound of a cell's log-odds; the lower, the sooner what has moved away is forgotten",
        low=0.1,
        high=50.0,
    )
    clear_range_m: float = setting(
        8.0, "beams without return clear their way up to here, and no beam clears beyond", unit="m", low=0.5, high=100.0
    )

    def __post_init__(self) -> None:
        check_settings(self)


class LogOddsGrid:
    """Adds scans at known poses; a cell is known as soon as one beam has crossed or met it."""

    def __init__(self, settings: LogOddsSettings, frame_id: str) -> None:
        self.settings = settings
        self.frame_id = frame_id
        self._corner = np.zeros(2, np.int64)  # cell of the world grid at [0, 0]
        self._log_odds = np.zeros((0, 0), np.float32)
        self._seen = np.zeros((0, 0), np.bool_)

    def add(self, points: ScanPoints, base: Pose2) -> None:
        """Add one scan taken with the base at ``base`` in the map's frame.

        Raises
        ------
        MapTooLargeError: the map is left as it was.
        """
        settings = self.settings
        origin = base.transform(np.array([points.origin]))[0]
        hits = base.transform(points.hits)
        rays = self._clearing_ends(origin, np.vstack([hits, base.transform(points.misses)]))
        corners = np.vstack([origin[None], hits, rays])
        self._cover(corners)
        cells = self._in_cells(np.vstack([origin[None], rays])) - self._corner
        low = np.floor(cells.min(axis=0)).astype(int)
        size = np.floor(cells.max(axis=0)).astype(int) - low + 1
        crossed = np.zeros((size[1], size[0]), np.uint8)
        ends = np.rint((cells - low - 0.5) * (1 << _SHIFT)).astype(np.int32)
        lines = np.stack([np.broadcast_to(ends[0], (len(ends) - 1, 2)), ends[1:]], axis=1)
        cv2.polylines(crossed, list(lines), False, 1, 1, cv2.LINE_8, _SHIFT)
        met = np.floor(self._in_cells(hits)).astype(int) - self._corner
        inside = ((met >= low) & (met < low + size)).all(axis=1)
        crossed[met[inside, 1] - low[1], met[inside, 0] - low[0]] = 0
        window = (slice(low[1], low[1] + size[1]), slice(low[0], low[0] + size[0]))
        self._log_odds[window] -= settings.miss * crossed
        self._seen[window] |= crossed.astype(np.bool_)
        rows, columns = met[:, 1], met[:, 0]
        self._log_odds[rows, columns] += settings.hit  # once, however many beams end in it
        self._seen[rows, columns] = True
        np.clip(self._log_odds[window], -settings.most, settings.most, out=self._log_odds[window])
        self._log_odds[rows, columns] = np.minimum(self._log_odds[rows, columns], settings.most)

    def as_map(self, around: Pose2 | None = None, radius_m: float = math.inf) -> OccupancyMap:
        """The chance of each cell to be occupied, of all or of those near a place; cells never seen are unknown."""
        resolution = self.settings.resolution_m
        low, high = np.zeros(2, np.int64), np.array(self._log_odds.shape[::-1])
        if around is not None and math.isfinite(radius_m):
            centre = np.floor(self._in_cells(np.array([around.x_m, around.y_m]))).astype(np.int64) - self._corner
            reach = math.ceil(radius_m / resolution)
            low, high = np.clip(centre - reach, 0, high), np.clip(centre + reach + 1, 0, high)
        window = (slice(low[1], high[1]), slice(low[0], high[0]))
        percent = np.rint(100.0 / (1.0 + np.exp(-self._log_odds[window]))).astype(np.int8)
        percent[~self._seen[window]] = UNKNOWN
        corner = (self._corner + low) * resolution + self.settings.grid_shift_m
        return OccupancyMap(self.frame_id, resolution, Pose2(float(corner[0]), float(corner[1]), 0.0), percent)

    def _in_cells(self, points: Array) -> Array:
        """Places of the map's frame, in cells of the world grid."""
        return (points - self.settings.grid_shift_m) / self.settings.resolution_m

    def _clearing_ends(self, origin: Array, ends: Array) -> Array:
        """Where beams stop to clear: at what they met, or at the clearing range."""
        along = ends - origin
        lengths = np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-9)
        share: Array = np.minimum(1.0, self.settings.clear_range_m / lengths)
        return origin + along * share[:, None]

    def _cover(self, points: Array) -> None:
        """Grow so that all points have a cell."""
        resolution = self.settings.resolution_m
        if not np.isfinite(points).all() or np.abs(points).max() > 1e6:
            raise MapTooLargeError("a scan has points beyond 1000 km or not finite")
        low = np.floor(self._in_cells(points.min(axis=0))).astype(np.int64)
        high = np.floor(self._in_cells(points.max(axis=0))).astype(np.int64) + 1
        height, width = self._log_odds.shape
        now_low = self._corner if height else low
        now_high = self._corner + np.array([width, height]) if height else low
        if height and (low >= now_low).all() and (high <= now_high).all():
            return
        step = math.ceil(_GROWTH_M / resolution)
        new_low = np.where(low < now_low, low - step, now_low) if height else low - step
        new_high = np.where(high > now_high, high + step, now_high) if height else high + step
        size = new_high - new_low
        if size[0] * size[1] > _MOST_CELLS:
            raise MapTooLargeError(f"a map of {size[0]} x {size[1]} cells would exceed {_MOST_CELLS} cells")
        log_odds = np.zeros((size[1], size[0]), np.float32)
        seen = np.zeros((size[1], size[0]), np.bool_)
        shift = now_low - new_low
        old = (slice(shift[1], shift[1] + height), slice(shift[0], shift[0] + width))
        log_odds[old], seen[old] = self._log_odds, self._seen
        self._corner, self._log_odds, self._seen = new_low, log_odds, seen
