"""What the band has to keep clear of."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint
from tracked_navigation.band.interval_cost import FAR_M, MOVER_FIELDS, MOVER_SLOTS, POINT_SLOTS, SLOT_COUNT
from tracked_types import Mover, seconds_between

Array = NDArray[np.float64]
THINNED_M = 0.03  # points within one cell of this size are one to the optimiser, never to the check
SEGMENT_STEP_M = 0.05  # between points on a segment, for the optimiser
AROUND_M = 1.0  # beside a band, points may matter to the optimiser
_FAR = 1e9


class BadSurroundings(ValueError):
    """What is wrong with obstacles or movers, in words."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """Obstacles and movers as of one instant.

    points: (m, 2). segments: (s, 2, 2), their ends. thinned: (k, 2) points of both for the optimiser. movers: (j, 5)
    place and velocity at the instant, and radius.
    """

    points: Array
    segments: Array
    thinned: Array
    movers: Array

    @classmethod
    def of(
        cls, points: Array, segments: Array, movers: tuple[Mover, ...], *, stamp_ns: int, frame_id: str
    ) -> "Surroundings":
        """Everything in one frame, movers carried on to ``stamp_ns``.

        Raises
        ------
        BadSurroundings: if a shape or a frame is wrong or a number is not finite.
        """
        points = _checked("obstacle points", points, (2,))
        segments = _checked("obstacle segments", segments, (2, 2))
        rows = np.zeros((len(movers), MOVER_FIELDS))
        for row, mover in zip(rows, movers, strict=True):
            if mover.frame_id != frame_id:
                raise BadSurroundings(f"mover {mover.identity} is in frame {mover.frame_id!r}, not {frame_id!r}")
            row[:2] = mover.position_at(seconds_between(stamp_ns, mover.stamp_ns))
            row[2:4], row[4] = mover.velocity_mps, mover.radius_m
            if not np.isfinite(row).all() or mover.radius_m < 0.0:
                raise BadSurroundings(f"mover {mover.identity} has numbers that make no sense")
        along = [_points_on(segment) for segment in segments]
        return cls(points, segments, _thinned(np.concatenate([points, *along])), rows)

    @classmethod
    def none(cls) -> "Surroundings":
        """Nothing is known to be there."""
        return cls(np.zeros((0, 2)), np.zeros((0, 2, 2)), np.zeros((0, 2)), np.zeros((0, MOVER_FIELDS)))

    def around(self, nodes: Array) -> "Surroundings":
        """With the optimiser's points about the nodes (n, .) of a band only."""
        low, high = nodes[:, :2].min(axis=0) - AROUND_M, nodes[:, :2].max(axis=0) + AROUND_M
        near = ((self.thinned >= low) & (self.thinned <= high)).all(axis=1)
        return Surroundings(self.points, self.segments, self.thinned[near], self.movers)

    def associate(self, nodes: Array, footprint: Footprint) -> Array:
        """Slots (n, .) of the band's functions: of each node (n, 6) the nearest point in each quadrant around the
        robot, so that walls on either side both count, and the nearest movers."""
        slots = np.full((len(nodes), SLOT_COUNT), 0.0)
        slots[:, : 2 * POINT_SLOTS] = FAR_M
        if len(self.thinned):
            slots[:, : 2 * POINT_SLOTS] = self._nearest_points(nodes, footprint)
        mover_slots = slots[:, 2 * POINT_SLOTS :].reshape(len(nodes), MOVER_SLOTS, MOVER_FIELDS)
        mover_slots[:, :, :2] = FAR_M
        count = min(len(self.movers), MOVER_SLOTS)
        if count:
            gaps = self._mover_gaps(nodes)
            chosen = (
                np.argsort(gaps, axis=1, kind="stable")[:, :count]
                if len(self.movers) > 1
                else np.zeros((len(nodes), 1), dtype=np.intp)
            )
            mover_slots[:, :count] = self.movers[chosen]
        return slots

    def _nearest_points(self, nodes: Array, footprint: Footprint) -> Array:
        cosine, sine = np.cos(nodes[:, 2:3]), np.sin(nodes[:, 2:3])
        right, up = self.thinned[:, 0] - nodes[:, 0:1], self.thinned[:, 1] - nodes[:, 1:2]
        ahead, aside = cosine * right + sine * up, cosine * up - sine * right
        along = np.abs(ahead - 0.5 * (footprint.front_m - footprint.rear_m))
        along -= 0.5 * (footprint.front_m + footprint.rear_m)
        across = np.abs(aside) - footprint.half_width_m
        # Outside the square of the distance, inside the depth: the same order, without roots.
        inside = np.minimum(np.maximum(along, across), 0.0)
        gap = np.maximum(along, 0.0) ** 2 + np.maximum(across, 0.0) ** 2 + inside
        found = np.full((len(nodes), POINT_SLOTS, 2), FAR_M)
        rows = np.arange(len(nodes))
        front, left = ahead >= 0.0, aside >= 0.0
        for slot, quadrant in enumerate((front & left, ~front & left, front & ~left, ~front & ~left)):
            here = np.where(quadrant, gap, _FAR)
            nearest = here.argmin(axis=1)
            present = here[rows, nearest] < _FAR
            found[present, slot] = self.thinned[nearest[present]]
        return found.reshape(len(nodes), 2 * POINT_SLOTS)

    def _mover_gaps(self, nodes: Array) -> Array:
        places = self.movers[:, :2] + nodes[:, 5, None, None] * self.movers[:, 2:4]
        offsets = places - nodes[:, None, :2]
        gaps: Array = np.hypot(offsets[..., 0], offsets[..., 1]) - self.movers[:, 4]
        return gaps


def _checked(name: str, values: Array, tail: tuple[int, ...]) -> Array:
    array = np.asarray(values, dtype=np.float64)
    if array.size == 0:
        return np.zeros((0, *tail))
    if array.shape[1:] != tail or array.ndim != len(tail) + 1:
        raise BadSurroundings(f"{name} must have shape (n, {', '.join(map(str, tail))}), got {array.shape}")
    if not np.isfinite(array).all():
        raise BadSurroundings(f"{name} hold a value that is not finite")
    return array


def _points_on(segment: Array) -> Array:
    length = float(np.hypot(*(segment[1] - segment[0])))
    shares = np.linspace(0.0, 1.0, max(2, int(np.ceil(min(length, 1e3) / SEGMENT_STEP_M)) + 1))
    points: Array = segment[0] + shares[:, None] * (segment[1] - segment[0])
    return points


def _thinned(points: Array) -> Array:
    """The first point of every cell."""
    if len(points) < 2:
        return points
    cells = np.floor(np.clip(points, -1e6, 1e6) / THINNED_M).astype(np.int64)
    _, first = np.unique(cells[:, 0] * (1 << 31) + cells[:, 1], return_index=True)
    kept: Array = points[np.sort(first)]
    return kept
