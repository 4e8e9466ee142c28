"""Exact distances between the robot's footprint and what is around it, along sampled poses."""

import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint
from tracked_navigation.band.surroundings import Surroundings

Array = NDArray[np.float64]
NOTHING_NEAR_M = np.inf


def clearances(times: Array, states: Array, surroundings: Surroundings, footprint: Footprint, within_m: float) -> Array:
    """Distance (m,) from the footprint at each state (m, 3) to the nearest thing at each time (m,).

    Things farther than ``within_m`` may count as infinitely far. A contact is zero or less.
    """
    reach = float(np.hypot(max(footprint.front_m, footprint.rear_m), footprint.half_width_m)) + within_m
    found = np.full(len(states), NOTHING_NEAR_M)
    for gap in (
        _to_points(states, surroundings.points, footprint, reach),
        _to_segments(states, surroundings.segments, footprint, reach),
        _to_movers(times, states, surroundings.movers, footprint),
    ):
        np.minimum(found, gap, out=found)
    return found


def _to_points(states: Array, points: Array, footprint: Footprint, reach: float) -> Array:
    found = np.full(len(states), NOTHING_NEAR_M)
    low, high = states[:, :2].min(axis=0) - reach, states[:, :2].max(axis=0) + reach
    points = points[((points >= low) & (points <= high)).all(axis=1)]
    if len(points):
        right, up = points[:, 0] - states[:, 0:1], points[:, 1] - states[:, 1:2]
        row, column = np.nonzero(right * right + up * up < reach * reach)
        np.minimum.at(found, row, footprint.distance(_local(states[row], points[column])))
    return found


def _to_segments(states: Array, segments: Array, footprint: Footprint, reach: float) -> Array:
    found = np.full(len(states), NOTHING_NEAR_M)
    if not len(segments):
        return found
    row, column = np.nonzero(_distance_to_segment(states[:, None, :2], segments[:, 0], segments[:, 1]) < reach)
    if not len(row):
        return found
    first, last = _local(states[row], segments[column, 0]), _local(states[row], segments[column, 1])
    gap = np.minimum(footprint.distance(first), footprint.distance(last))
    for corner in footprint.corners:
        np.minimum(gap, _distance_to_segment(corner, first, last), out=gap)
    gap[_crosses(first, last, footprint)] = 0.0
    np.minimum.at(found, row, gap)
    return found


def _to_movers(times: Array, states: Array, movers: Array, footprint: Footprint) -> Array:
    found = np.full(len(states), NOTHING_NEAR_M)
    for mover in movers:
        places = mover[:2] + times[:, None] * mover[2:4]
        np.minimum(found, footprint.distance(_local(states, places)) - mover[4], out=found)
    return found


def _local(states: Array, points: Array) -> Array:
    """Points (k, 2), each in the frame of the robot at its own state (k, 3)."""
    cosine, sine = np.cos(states[:, 2]), np.sin(states[:, 2])
    right, up = points[:, 0] - states[:, 0], points[:, 1] - states[:, 1]
    return np.column_stack([cosine * right + sine * up, cosine * up - sine * right])


def _distance_to_segment(points: Array, first: Array, last: Array) -> Array:
    """Distance of points (..., 2) from segments (..., 2) to (..., 2)."""
    along = last - first
    square = np.maximum((along * along).sum(axis=-1), 1e-18)
    share = np.clip(((points - first) * along).sum(axis=-1) / square, 0.0, 1.0)
    offset = points - first - share[..., None] * along
    distance: Array = np.hypot(offset[..., 0], offset[..., 1])
    return distance


def _crosses(first: Array, last: Array, footprint: Footprint) -> NDArray[np.bool_]:
    """Whether segments (k, 2) to (k, 2) of the base's frame meet the rectangle: clipped by its four sides."""
    along = last - first
    enter, leave = np.zeros(len(first)), np.ones(len(first))
    apart = np.zeros(len(first), dtype=np.bool_)
    bounds = ((-footprint.rear_m, footprint.front_m), (-footprint.half_width_m, footprint.half_width_m))
    for axis, (low, high) in enumerate(bounds):
        parallel = np.abs(along[:, axis]) < 1e-12
        apart |= parallel & ((first[:, axis] < low) | (first[:, axis] > high))
        divisor = np.where(parallel, 1.0, along[:, axis])
        one, other = (low - first[:, axis]) / divisor, (high - first[:, axis]) / divisor
        enter = np.where(parallel, enter, np.maximum(enter, np.minimum(one, other)))
        leave = np.where(parallel, leave, np.minimum(leave, np.maximum(one, other)))
    crossing: NDArray[np.bool_] = ~apart & (enter <= leave)
    return crossing
